"""Names on the command line resolved to an archive, a run, a folder or one file."""

import fnmatch
import json
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from squealpipe.store.checkout import ROOT as CHECKOUT
from squealpipe.store.whole_files import ARCHIVES, MANIFEST, SEAL, StoreError, checksum

RUN_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,79}")


@dataclass(frozen=True)
class Verification:
    """Files of an archive that its manifest shows as changed, missing or extra, if any."""

    folder: Path
    files: int
    findings: list[str]

    @property
    def intact(self) -> bool:
        """Return whether every byte is as it was frozen."""
        return not self.findings

    def lines(self) -> list[str]:
        """The findings, for people."""
        if self.intact:
            return [f"{self.folder}: intact, {self.files} files as they were frozen"]
        title = f"{self.folder}: NOT as it was frozen ({len(self.findings)} findings)"
        return [title, *(f"  {line}" for line in self.findings)]


def matches_any(name: str, patterns: Iterable[str]) -> bool:
    """Return whether a path in an archive, like ``data/whirl.nc``, fits one of some patterns."""
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def read_manifest(folder: Path) -> dict[str, Any]:
    """Manifest of an archive; empty where it is damaged or the folder is not an archive."""
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    files = manifest.get("files") if isinstance(manifest, dict) else None
    whole = isinstance(files, dict) and all(
        isinstance(entry, dict) for entry in files.values()
    )
    return manifest if whole else {}


def seal_text(folder: Path) -> str:
    """The line that seals the manifest of an archive, as `sha256sum` writes and checks it."""
    return f"{checksum(folder / MANIFEST)}  {MANIFEST}\n"


def archive_folder(name: str, root: str | os.PathLike[str] = ".") -> Path:
    """Folder of an archive of that name."""
    if not RUN_NAME.fullmatch(name):
        raise ValueError(
            f"archive name {name!r}: use up to 80 letters, digits, '.', '_' and '-', "
            "beginning with a letter or digit"
        )
    return Path(root) / ARCHIVES / name


def locate(what: str | os.PathLike[str], root: str | os.PathLike[str] = ".") -> Path:
    """The folder or file that is meant: a path that exists, or the name of an archive.

    Archives are those of ``root`` and those that came with the checkout of this package.
    """
    path = Path(what)
    if path.exists():
        return path
    if RUN_NAME.fullmatch(str(what)):
        for place in (root, CHECKOUT):
            archive = archive_folder(str(what), place)
            if archive.is_dir():
                return archive
    folders = [Path(place) / ARCHIVES for place in (root, CHECKOUT)]
    items = [item for folder in folders for item in folder.glob("[!.]*")]
    known = sorted({item.name for item in items if item.is_dir()})
    raise FileNotFoundError(
        f"no archive, folder or file {str(what)!r}; "
        + (
            f"archives: {', '.join(known)}"
            if known
            else "there are no archives yet; reference comes with the repository of squealpipe"
        )
    )


def verify(
    what: str | os.PathLike[str], root: str | os.PathLike[str] = ".", part: str = ""
) -> Verification:
    """Compare every byte of an archive, or of a folder in it, with its manifest."""
    folder = locate(what, root)
    if not (folder / MANIFEST).is_file():
        raise FileNotFoundError(f"{folder} has no {MANIFEST}; it is not an archive")
    files = read_manifest(folder).get("files", {})
    if not files:
        return Verification(folder, 0, [f"changed: {MANIFEST} (damaged)"])
    listed = {path: files[path] for path in files if path.startswith(part)}
    there = (
        path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir()
    )
    names = (path.relative_to(folder).as_posix() for path in there)
    present = {name for name in names if name.startswith(part)}
    faults = [
        f"changed: {path}"
        for path in sorted(present & set(listed))
        if (folder / path).is_symlink()
        or checksum(folder / path) != listed[path].get("sha256")
    ]
    seal = folder / SEAL
    if not seal.is_file() or seal.read_bytes() != seal_text(folder).encode():
        faults.append(f"changed: {MANIFEST}")
    faults += [f"missing: {path}" for path in sorted(set(listed) - present)]
    faults += [
        f"extra: {path}" for path in sorted(present - set(listed) - {MANIFEST, SEAL})
    ]
    return Verification(folder, len(listed), faults)


def dataset_files(place: Path) -> dict[str, Path]:
    """Dataset name (path below the data folder, without suffix) → file.

    Args:
        place: an archive or a run (both have ``data/``), a folder of datasets, or one file.

    Raises:
        ValueError: there is none.
        StoreError: those of an archive are not as they were frozen.
    """
    if place.is_file():
        return {place.stem: place}
    if (place / MANIFEST).is_file() and not (
        frozen := verify(place, part="data/")
    ).intact:
        raise StoreError("\n".join(frozen.lines()))
    base = place / "data" if (place / "data").is_dir() else place
    files = {
        path.relative_to(base).with_suffix("").as_posix(): path
        for path in regular_files(base)
        if path.suffix == ".nc"
    }
    if not files:
        raise ValueError(
            f"{place} holds no dataset (*.nc); run snakemake first, or check the path"
        )
    return files


def regular_files(base: Path) -> list[Path]:
    """Files below a folder, sorted, without hidden ones; links are not followed."""
    return sorted(
        path
        for path in base.rglob("*")
        if path.is_file()
        and not path.is_symlink()
        and not any(name.startswith(".") for name in path.relative_to(base).parts)
    )


def refuse_copy(name: str, path: Path, stated: Mapping[str, Any]) -> None:
    """Raise if the attributes of a dataset state that it was made under another name."""
    made_as = str(stated.get("key", "")).partition(" ")[2]
    if made_as not in {"", f"data/{name}.nc"}:
        raise StoreError(
            f"{path} is a copy of {made_as}; delete it and run snakemake again"
        )
