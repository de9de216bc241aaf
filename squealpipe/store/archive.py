"""Frozen runs: everything that made a result and the result itself, with checksums."""

from __future__ import annotations

import datetime
import hashlib
import importlib.metadata
import json
import os
import platform
import shutil
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from squealpipe.config import Study, read_study
from squealpipe.store.crate import METADATA, describe
from squealpipe.store.netcdf import StoreError, load, sync
from squealpipe.store.provenance import commit
from squealpipe.store.runs import (
    LEFT_OUT,
    MANIFEST,
    archive_folder,
    dataset_files,
    locate,
    matches_any,
    read_manifest,
    regular_files,
)

PARTS = ("data", "figures", "report")
"""Folders of a run that are frozen."""

SEAL = "manifest.sha256"
"""Holds the checksum of the manifest, so that an edited manifest is noticed too."""


@dataclass(frozen=True)
class Verification:
    """What differs between an archive and its manifest; nothing: it is intact."""

    folder: Path
    files: int
    changed: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    extra: list[str] = field(default_factory=list)
    unsafe: list[str] = field(default_factory=list)

    @property
    def intact(self) -> bool:
        """Whether every byte is as it was frozen."""
        return not (self.changed or self.missing or self.extra or self.unsafe)

    def lines(self) -> list[str]:
        """The findings, for people."""
        if self.intact:
            return [f"{self.folder}: intact, {self.files} files as they were frozen"]
        found = [
            f"  {word}: {name}"
            for word in ("unsafe", "changed", "missing", "extra")
            for name in getattr(self, word)
        ]
        return [f"{self.folder}: NOT as it was frozen ({len(found)} findings)", *found]


def archive(
    name: str,
    *,
    results: str | os.PathLike[str] | None = None,
    configs: Iterable[str | os.PathLike[str]] = ("workflow/config/paper.yaml",),
    root: str | os.PathLike[str] = ".",
    leave_out: Iterable[str] = (),
) -> Path:
    """Freeze a run under ``results/archive/NAME``; the folder appears whole or not at all.

    Args:
        name: of the archive.
        results: folder of the run; the one that the configuration names by default.
        configs: the configuration files of the run, later ones laid over earlier ones.
        root: the checkout.
        leave_out: what is not frozen: suffixes (``".svg"``) or patterns of paths in the archive
            (``"data/simulate/*"``); the manifest lists them, and a comparison skips them.

    Returns:
        The folder of the archive.

    Raises:
        FileNotFoundError: there is no run.
        ValueError: the name is taken or not allowed, a dataset is damaged or was made with
            another configuration.
    """
    base = Path(root)
    target = archive_folder(name, root)
    if target.exists():
        raise ValueError(f"{target} exists; archives never change: choose another name")
    config_files = [base / path for path in configs]
    study = read_study(*config_files)
    run = base / (study.results if results is None else results)
    if not run.is_dir():
        raise FileNotFoundError(f"no run in {run}; run snakemake first")
    _refuse_stale(run, study)
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{name}.", suffix=".tmp"))
    try:
        draft.chmod(0o755)
        patterns = [f"*{entry}" if entry.startswith(".") else entry for entry in leave_out]
        _copy_run(run, draft, patterns)
        _copy_setting(config_files, study, base, draft)
        frozen_at = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        (draft / METADATA).write_text(describe(draft, name, frozen_at), encoding="utf-8")
        _seal(draft, {"name": name, "frozen": frozen_at, LEFT_OUT: patterns})
        draft.rename(target)
        sync(target.parent)
    except OSError as error:
        raise StoreError(
            f"cannot write {target}: {error.strerror or error}; free space or mend permissions, "
            "then run the same command again"
        ) from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return target


def verify(what: str | os.PathLike[str], root: str | os.PathLike[str] = ".") -> Verification:
    """Compare every byte of an archive with its manifest.

    Args:
        what: name or folder of an archive.
        root: the checkout.

    Raises:
        FileNotFoundError: no such archive.
        ValueError: its manifest is too large to be one.
    """
    folder = locate(what, root)
    if not (folder / MANIFEST).is_file():
        raise FileNotFoundError(f"{folder} has no {MANIFEST}; it is not an archive")
    listed = _listed_files(folder)
    if listed is None:
        return Verification(folder=folder, files=0, changed=[f"{MANIFEST} (damaged)"])
    unsafe = sorted(path for path in listed if not _stays_inside(path))
    unsafe += sorted(
        f"{path} (link)" for path in _everything(folder) if (folder / path).is_symlink()
    )
    expected = {path: entry for path, entry in listed.items() if _stays_inside(path)}
    present = {path for path in _everything(folder) if not (folder / path).is_symlink()}
    changed = [
        path
        for path in sorted(present & set(expected))
        if (folder / path).stat().st_size != expected[path].get("bytes")
        or checksum(folder / path) != expected[path].get("sha256")
    ]
    if not _seal_fits(folder):
        changed.append(MANIFEST)
    return Verification(
        folder=folder,
        files=len(expected),
        changed=changed,
        missing=sorted(set(expected) - present),
        extra=sorted(present - set(expected) - {MANIFEST, SEAL}),
        unsafe=unsafe,
    )


def checksum(path: Path) -> str:
    """SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _refuse_stale(run: Path, study: Study) -> None:
    """Every dataset must be whole and made with the configuration that is frozen with it."""
    stale = []
    for name, path in dataset_files(run).items():
        dataset = load(path)
        part = json.loads(dataset.attrs.get("config", "{}"))
        # Plain keys that are no section tell one file of a rule from another: scene, mode.
        part = {key: part[key] for key in part if "." in key or key in Study.model_fields}
        try:
            current = study.slice(*part)
        except (KeyError, TypeError):
            current = None
        if current != part:
            stale.append(name)
    if stale:
        raise ValueError(
            f"{run}: made with another configuration: {', '.join(stale)}; run snakemake first, "
            "with the same --configfile, and delete datasets that are no longer made"
        )


def _copy_run(run: Path, draft: Path, patterns: list[str]) -> None:
    for part in PARTS:
        for path in regular_files(run / part):
            name = path.relative_to(run)
            if matches_any(name.as_posix(), patterns):
                continue
            copy = draft / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)


def _copy_setting(configs: list[Path], study: Study, base: Path, draft: Path) -> None:
    """Configuration as written and as resolved, lock, and environment."""
    folder = draft / "config"
    folder.mkdir()
    for path in configs:
        shutil.copyfile(path, folder / path.name)
    resolved = study.model_dump(mode="json")
    (folder / "resolved.yaml").write_text(yaml.safe_dump(resolved), encoding="utf-8")
    for name in ("requirements.lock", "LICENSE", "CITATION.cff"):
        if (base / name).is_file():
            shutil.copyfile(base / name, draft / name)
    environment = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "commit": commit(),
        "packages": {
            item.metadata["Name"]: item.version for item in importlib.metadata.distributions()
        },
    }
    text = json.dumps(environment, indent=1, sort_keys=True)
    (draft / "environment.json").write_text(text + "\n", encoding="utf-8")


def _seal(draft: Path, about: dict[str, Any]) -> None:
    files = {
        path.relative_to(draft).as_posix(): {
            "bytes": path.stat().st_size,
            "sha256": checksum(path),
        }
        for path in regular_files(draft)
    }
    manifest = {"format": 1, **about, "files": files}
    (draft / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    (draft / SEAL).write_text(_seal_text(draft), encoding="utf-8")
    for path in regular_files(draft):
        sync(path)


def _seal_text(folder: Path) -> str:
    return f"{checksum(folder / MANIFEST)}  {MANIFEST}\n"


def _seal_fits(folder: Path) -> bool:
    seal = folder / SEAL
    return seal.is_file() and seal.read_bytes() == _seal_text(folder).encode()


def _listed_files(folder: Path) -> dict[str, dict[str, Any]] | None:
    """File name → entry; None if the manifest is damaged."""
    manifest = read_manifest(folder)
    try:
        files = manifest["files"]
        return {str(name): dict(entry) for name, entry in files.items()}
    except (KeyError, TypeError, AttributeError, ValueError):
        return None


def _everything(folder: Path) -> list[str]:
    """Every file and link below the folder, hidden ones too."""
    found: list[str] = []
    for place, subfolders, names in os.walk(folder, followlinks=False):
        links = [name for name in subfolders if Path(place, name).is_symlink()]
        found.extend(Path(place, name).relative_to(folder).as_posix() for name in names + links)
    return sorted(found)


def _stays_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts and "\\" not in name and name != ""
