"""What a name on the command line stands for: an archive, a run, a folder or one file."""

import fnmatch
import json
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from squealpipe.store.whole_files import checksum

ARCHIVES = Path("results/archive")
MANIFEST = "manifest.json"
SEAL = "manifest.sha256"
"""Holds the checksum of the manifest, so that an edited manifest is noticed too."""
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,79}")


LEFT_OUT = "left_out"


def matches_any(name: str, patterns: Iterable[str]) -> bool:
    """Whether a path in an archive, like ``data/whirl.nc``, fits one of some patterns."""
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def read_manifest(folder: Path) -> dict[str, Any]:
    """Manifest of an archive; empty where it is damaged or the folder is not an archive."""
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    files = manifest.get("files") if isinstance(manifest, dict) else None
    whole = isinstance(files, dict) and all(isinstance(entry, dict) for entry in files.values())
    return manifest if whole else {}


def seal_fits(folder: Path) -> bool:
    """Whether the manifest of an archive is as it was sealed."""
    seal = folder / SEAL
    return seal.is_file() and seal.read_bytes() == seal_text(folder).encode()


def seal_text(folder: Path) -> str:
    """The line that seals the manifest of an archive, as `sha256sum` writes and checks it."""
    return f"{checksum(folder / MANIFEST)}  {MANIFEST}\n"


def archive_around(path: Path) -> Path | None:
    """The archive that a file is part of, if any."""
    return next((at for at in path.resolve().parents if (at / MANIFEST).is_file()), None)


def left_out(place: Path) -> list[str]:
    """Patterns of what an archive deliberately does not hold."""
    return list(read_manifest(place).get(LEFT_OUT, []))


def archive_folder(name: str, root: str | os.PathLike[str] = ".") -> Path:
    """Folder of an archive of that name."""
    if not NAME.fullmatch(name):
        raise ValueError(
            f"archive name {name!r}: use up to 80 letters, digits, '.', '_' and '-', "
            "beginning with a letter or digit"
        )
    return Path(root) / ARCHIVES / name


def locate(what: str | os.PathLike[str], root: str | os.PathLike[str] = ".") -> Path:
    """The folder or file that is meant: a path that exists, or the name of an archive."""
    path = Path(what)
    if path.exists():
        return path
    if NAME.fullmatch(str(what)):
        archive = archive_folder(str(what), root)
        if archive.is_dir():
            return archive
    folder = Path(root) / ARCHIVES
    known = sorted(item.name for item in folder.glob("[!.]*") if item.is_dir())
    raise FileNotFoundError(
        f"no archive, folder or file {str(what)!r}; "
        + (f"archives: {', '.join(known)}" if known else "there are no archives yet")
    )


def dataset_files(place: Path) -> dict[str, Path]:
    """Dataset name (path below the data folder, without suffix) → file.

    Args:
        place: an archive or a run (both have ``data/``), a folder of datasets, or one file.
    """
    if place.is_file():
        return {place.stem: place}
    base = place / "data" if (place / "data").is_dir() else place
    found = {
        path.relative_to(base).with_suffix("").as_posix(): path
        for path in regular_files(base)
        if path.suffix == ".nc"
    }
    if not found:
        raise ValueError(f"{place} holds no dataset (*.nc); run snakemake first, or check the path")
    return found


def regular_files(base: Path) -> Iterator[Path]:
    """Files below a folder, sorted, without hidden ones; links are not followed."""
    for folder, subfolders, names in os.walk(base, followlinks=False):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        for name in sorted(names):
            path = Path(folder, name)
            if name.startswith(".") or path.is_symlink():
                continue
            yield path
