"""Frozen runs: everything that made a result and the result itself, with checksums."""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import os
import platform
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import yaml

from squealpipe.config.settings import Study, read_study
from squealpipe.store.checkout import commit
from squealpipe.store.crate import METADATA, describe
from squealpipe.store.identity import canonical
from squealpipe.store.memory.objects import (
    DRAFT,
    OBJECTS,
    checksum,
    locked,
    object_path,
    seal_fits,
    seal_text,
    share,
)
from squealpipe.store.netcdf import StoreError, load, sync
from squealpipe.store.runs import (
    LEFT_OUT,
    MANIFEST,
    SEAL,
    archive_folder,
    dataset_files,
    listed_files,
    locate,
    matches_any,
    regular_files,
)

PARTS = ("data", "figures", "report")
"""Folders of a run that are frozen."""


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
    patterns = [f"*{entry}" if entry.startswith(".") else entry for entry in leave_out]
    try:
        with locked(target.parent):
            draft = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{name}.", suffix=DRAFT))
            try:
                draft.chmod(0o777 & ~_umask())
                _copy_run(run, draft, patterns)
                _copy_setting(config_files, study, base, draft)
                frozen_at = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
                (draft / METADATA).write_text(describe(draft, name, frozen_at), encoding="utf-8")
                about = {"name": name, "frozen": frozen_at, "commit": commit(), LEFT_OUT: patterns}
                _seal(draft, {**about, "config": study.model_dump(mode="json")})
                draft.rename(target)
                sync(target.parent)
            finally:
                shutil.rmtree(draft, ignore_errors=True)
    except OSError as error:
        raise StoreError(
            f"cannot write {target}: {error.strerror or error}; free space or fix permissions, "
            "then run the same command again"
        ) from error
    return target


def verify(what: str | os.PathLike[str], root: str | os.PathLike[str] = ".") -> Verification:
    """Compare every byte of an archive, and of the objects it shares, with its manifest.

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
    listed = listed_files(folder)
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
    if not seal_fits(folder):
        changed.append(MANIFEST)
    changed += [
        f"{OBJECTS}/{digest} (shared object of {path})"
        for path, digest in _shared_apart(folder, expected)
        if checksum(object_path(folder.parent, digest)) != digest
    ]
    return Verification(
        folder=folder,
        files=len(expected),
        changed=changed,
        missing=sorted(set(expected) - present),
        extra=sorted(present - set(expected) - {MANIFEST, SEAL}),
        unsafe=unsafe,
    )


def _refuse_stale(run: Path, study: Study) -> None:
    """Every dataset must be whole and made with the configuration that is frozen with it."""
    stale = []
    for name, path in dataset_files(run).items():
        dataset = load(path)
        part = json.loads(dataset.attrs.get("config", "{}"))
        # Plain keys that are no section tell one file of a rule from another: scene, mode.
        part = {key: part[key] for key in part if "." in key or key in Study.model_fields}
        if name.startswith("sweeps/"):
            sweep = name.removeprefix("sweeps/")
            current = json.loads(canonical(study.sweep(sweep))) if sweep in study.sweeps else None
            part = json.loads(dataset.attrs.get("config", "{}"))
        else:
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
    (draft / SEAL).write_text(seal_text(draft), encoding="utf-8")
    for name in (MANIFEST, SEAL):
        (draft / name).chmod(0o444 & ~_umask())
    for name, entry in files.items():
        path = draft / name
        path.chmod(0o444 & ~_umask())  # its content may be that of other archives too
        share(path, str(entry["sha256"]), draft.parent)
    for path in regular_files(draft):
        sync(path)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _shared_apart(folder: Path, listed: dict[str, dict[str, Any]]) -> Iterator[tuple[str, str]]:
    """Files whose object exists but is not the file itself, with their checksum."""
    for path, entry in listed.items():
        digest = str(entry.get("sha256"))
        kept = object_path(folder.parent, digest)
        file = folder / path
        if digest.isalnum() and kept.is_file() and not (file.is_file() and kept.samefile(file)):
            yield path, digest


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
