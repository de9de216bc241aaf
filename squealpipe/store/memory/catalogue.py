"""What runs there are: archives and folders of results, found again by their parameters.

An index beside the archives spares reading them. Each entry holds the seal, size and date of the
manifest (or of the datasets) that it was read from; where those differ it is read again, so a
missing, old or damaged index costs time, never truth.
"""

from __future__ import annotations

import contextlib
import datetime
import json
import os
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import yaml

from squealpipe.config.settings import PAPER, Study, read_study
from squealpipe.config.yaml_files import flat
from squealpipe.store.memory.objects import seal_fits
from squealpipe.store.memory.results import open_lazily
from squealpipe.store.netcdf import StoreError
from squealpipe.store.runs import ARCHIVES, MANIFEST, SEAL, dataset_files, read_manifest

INDEX = ".index.json"
FORMAT = 1
NOT_COMPARED = ("results",)
"""Configuration keys that say where, not what."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One archive or folder of results.

    Attributes:
        name: of the archive, or the folder.
        kind: "archive" or "results".
        date: when it was frozen or last changed, ISO.
        commit: of the code that froze or made it; empty if not told.
        size: bytes.
        config: dotted key → value of what made it.
        verified: when and with what answer it was last verified; empty: not since it is known.
        key: of the files that the entry was read from.
    """

    name: str
    kind: str
    date: str
    commit: str
    size: int
    config: dict[str, Any] = field(default_factory=dict)
    verified: str = ""
    key: list[Any] = field(default_factory=list)

    def changed(self, paper: dict[str, Any]) -> dict[str, Any]:
        """Configuration keys whose values are not the paper's."""
        return {
            key: value
            for key, value in self.config.items()
            if key not in NOT_COMPARED and paper.get(key) != value
        }


def runs(root: str | os.PathLike[str] = ".") -> list[Run]:
    """All archives and folders of results of a checkout, by name."""
    base = Path(root)
    known = _read_index(base)
    found = []
    for place in _places(base):
        key = _key(place)
        old = known.get(_name(place, base))
        found.append(old if old is not None and old.key == key else _read(place, base, key))
    if {run.name: run for run in found} != known:
        _write_index(base, found)
    return found


def note_verified(folder: Path, answer: str, root: str | os.PathLike[str] = ".") -> None:
    """Remember in the index what the verification of an archive said."""
    base = Path(root)
    today = datetime.datetime.now(datetime.UTC).date().isoformat()
    noted = [
        Run(**{**asdict(run), "verified": f"{answer} {today}"})
        if (base / ARCHIVES / run.name).resolve() == folder.resolve()
        else run
        for run in runs(base)
    ]
    _write_index(base, noted)


def paper_configuration(root: str | os.PathLike[str] = ".") -> dict[str, Any]:
    """Dotted key → value of the paper's study, or of the defaults where it is not kept."""
    path = Path(root) / PAPER
    study = read_study(path) if path.is_file() else Study()
    return flat(study.model_dump(mode="json"))


def _places(base: Path) -> Iterator[Path]:
    archives = base / ARCHIVES
    if archives.is_dir():
        for place in sorted(archives.iterdir()):
            if not place.name.startswith(".") and (place / MANIFEST).is_file():
                yield place
    results = base / ARCHIVES.parent
    for place in [results, *(sorted(results.iterdir()) if results.is_dir() else [])]:
        if place != archives and (place / "data").is_dir():
            yield place


def _name(place: Path, base: Path) -> str:
    return place.name if (place / MANIFEST).is_file() else place.relative_to(base).as_posix()


def _key(place: Path) -> list[Any]:
    """What changes whenever an entry has to be read again."""
    manifest = place / MANIFEST
    if manifest.is_file():
        stat, seal = manifest.stat(), place / SEAL
        told = seal.read_text(errors="replace")[:100] if seal.is_file() else ""
        return [told, stat.st_size, stat.st_mtime_ns]
    files = dataset_files(place).values() if any((place / "data").rglob("*.nc")) else []
    stats = [path.stat() for path in files]
    sizes, dates = [stat.st_size for stat in stats], [stat.st_mtime_ns for stat in stats]
    return [len(stats), sum(sizes), max(dates, default=0), sum(dates) % 2**52]


def _read(place: Path, base: Path, key: list[Any]) -> Run:
    if (place / MANIFEST).is_file():
        return _read_archive(place, key)
    config: dict[str, Any] = {}
    commits: set[str] = set()
    files = list(dataset_files(place).values()) if key[0] else []
    for path in files:
        with contextlib.suppress(StoreError):  # `verify` and `compare` tell of damage
            attrs = open_lazily(path).attrs
            told = json.loads(attrs.get("config", "{}"))
            keys = [name for name in told if name in Study.model_fields or "." in name]
            config |= {name: told[name] for name in keys}
            commits.add(str(attrs.get("commit", "")))
    newest = max((path.stat().st_mtime for path in files), default=0.0)
    return Run(
        name=_name(place, base),
        kind="results",
        date=datetime.datetime.fromtimestamp(newest, datetime.UTC).isoformat(timespec="seconds"),
        commit=", ".join(sorted(commits - {""})),
        size=sum(path.stat().st_size for path in files),
        config=flat(config),
        key=key,
    )


def _read_archive(place: Path, key: list[Any]) -> Run:
    manifest = read_manifest(place)
    config, commit = manifest.get("config"), manifest.get("commit")
    if not isinstance(config, dict):  # archives made before the manifest told it
        config = _older(place / "config/resolved.yaml")
    if commit is None:
        commit = _older(place / "environment.json").get("commit", "")
    files = manifest.get("files", {})
    sizes = [entry.get("bytes", 0) for entry in files.values()] if isinstance(files, dict) else []
    return Run(
        name=place.name,
        kind="archive",
        date=str(manifest.get("frozen", "")),
        commit=str(commit),
        size=sum(sizes),
        config=flat(config),
        verified="" if seal_fits(place) else "damaged manifest",
        key=key,
    )


def _older(path: Path) -> dict[str, Any]:
    """A mapping from YAML or JSON; empty where it is missing or damaged."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError):
        return {}
    return content if isinstance(content, dict) else {}


def _read_index(base: Path) -> dict[str, Run]:
    try:
        content = json.loads((base / ARCHIVES / INDEX).read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            return {}
        return {entry["name"]: Run(**entry) for entry in content["runs"]}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _write_index(base: Path, found: list[Run]) -> None:
    """Whole or not at all; a folder that cannot be written has no index."""
    folder = base / ARCHIVES
    text = json.dumps({"format": FORMAT, "runs": [asdict(run) for run in found]}, default=str)
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, prefix=INDEX)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        Path(name).replace(folder / INDEX)
