"""Frozen runs: everything that made a result and the result itself, with checksums."""

import datetime
import importlib.metadata
import json
import os
import platform
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from squealpipe.store.checkout import commit
from squealpipe.store.crate import describe
from squealpipe.store.keys import refuse_misfits
from squealpipe.store.rerun.key import files_named_in
from squealpipe.store.runs import archive_folder, matches_any, regular_files, seal_text
from squealpipe.store.whole_files import MANIFEST, SEAL, checksum, not_written, sync
from squealpipe.store.yaml_files import read_yaml
from squealpipe.study.configuration.settings import Study, files_of_laws, read_study
from squealpipe.study.configuration.structure import file_in, files_of_operating


def archive(
    name: str,
    *,
    keys: Mapping[str, str],
    configs: Iterable[str | os.PathLike[str]] = ("workflow/config/paper.yaml",),
    root: str | os.PathLike[str] = ".",
    leave_out: Iterable[str] = (),
) -> Path:
    """Freeze a run under ``results/archive/NAME``; the folder appears whole or not at all.

    Args:
        keys: every file that the rules make → the key that it must state.
        leave_out: what is not frozen: suffixes (``".svg"``) or patterns of paths in the archive
            (``"data/simulate/*"``); the manifest lists them, and a comparison skips them.

    Raises:
        FileNotFoundError: there is no run.
        ValueError: the name is taken or not allowed, or a result is missing, damaged or made with
            another configuration or other code.
    """
    base = Path(root)
    target = archive_folder(name, root)
    if target.exists():
        raise ValueError(f"{target} exists; archives never change: choose another name")
    config_files = [base / path for path in configs]
    study = read_study(*config_files)
    run = base / study.results
    if not run.is_dir():
        raise FileNotFoundError(f"no run in {run}; run snakemake first")
    patterns = [f"*{entry}" if entry.startswith(".") else entry for entry in leave_out]
    names = {path: path.removeprefix(f"{study.results}/") for path in keys}
    kept = {
        path: key
        for path, key in keys.items()
        if not matches_any(names[path], patterns)
    }
    refuse_misfits(kept, base)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(
            dir=target.parent, prefix=f".{name}."
        ) as folder:
            draft = Path(folder) / name
            for path in kept:
                copy = draft / names[path]
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(run / names[path], copy)
            environment = _copy_setting(config_files, study, base, draft)
            frozen_at = datetime.datetime.now(datetime.UTC).isoformat(
                timespec="seconds"
            )
            crate = describe(draft, name, frozen_at, environment, _sums(draft))
            metadata = "ro-crate-metadata.json"
            (draft / metadata).write_text(crate, encoding="utf-8")
            manifest = {
                "format": 1,
                "name": name,
                "frozen": frozen_at,
                "commit": commit(),
                "left_out": patterns,
                "config": study.model_dump(mode="json"),
                "files": _sums(draft),
            }
            (draft / MANIFEST).write_text(
                json.dumps(manifest, indent=1) + "\n", encoding="utf-8"
            )
            (draft / SEAL).write_text(seal_text(draft), encoding="utf-8")
            for file in regular_files(draft):
                file.chmod(file.stat().st_mode & 0o444)
                sync(file)
            for place in [draft, *(at for at in draft.rglob("*") if at.is_dir())]:
                sync(place)  # the names of the files in it
            draft.rename(target)
            sync(target.parent)
    except OSError as error:
        raise not_written(target, error) from error
    return target


def _copy_structure(config: Path, file: str, folder: Path) -> str:
    """Copy a structure's file and all that it names; its name in the archive's folder.

    It keeps its place beside the configuration if it lies there, so that the copy runs as it is.

    Raises:
        ValueError: a matrix lies elsewhere than the structure's file.
    """
    source = Path(os.path.normpath(config.parent / file))
    beside = source.is_relative_to(config.parent)
    root = config.parent if beside else source.parent
    target = folder if beside else folder / "structure"
    for name in files_named_in({"file": str(source)}):
        part = Path(os.path.normpath(name))
        if not part.is_relative_to(root):
            raise ValueError(
                f"{source} names {part}, which is not archived with it; move it below {root}"
            )
        copy = target / part.relative_to(root)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(part, copy)
    return (target / source.relative_to(root)).relative_to(folder).as_posix()


def _sums(draft: Path) -> dict[str, dict[str, Any]]:
    """Path of each file → its size and checksum."""
    return {
        path.relative_to(draft).as_posix(): {
            "bytes": path.stat().st_size,
            "sha256": checksum(path),
        }
        for path in regular_files(draft)
    }


@cache
def _installed() -> dict[str, str]:
    """Names and versions of the installed packages, each of whose files is read once."""
    abouts = [item.metadata for item in importlib.metadata.distributions()]
    return {about["Name"]: about["Version"] for about in abouts}


def _copy_setting(
    configs: list[Path], study: Study, base: Path, draft: Path
) -> dict[str, Any]:
    """Configuration as written and as resolved, lock, and environment, which is returned."""
    folder = draft / "config"
    folder.mkdir(parents=True)
    for path in configs:
        shutil.copyfile(path, folder / path.name)
        content = read_yaml(path)
        tables = [Path(section[key]) for section, key in files_of_operating(content)]
        for file in [*files_of_laws(path), *tables]:
            copy = folder / file
            if copy.resolve().is_relative_to(folder.resolve()):  # resolved.yaml has any
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path.parent / file, copy)
    resolved = study.model_dump(mode="json")
    for path in configs:
        if (named := file_in(read_yaml(path))) is not None:
            resolved["structure"]["file"] = _copy_structure(path, named, folder)
        content = read_yaml(path)
        for section, key in files_of_operating(content):
            there = resolved["operating"]
            (there if section is content["operating"] else there["mu_of"])[key] = (
                section[key]
            )
    (folder / "resolved.yaml").write_text(yaml.safe_dump(resolved), encoding="utf-8")
    for name in ("requirements.lock", "LICENSE", "CITATION.cff"):
        if (base / name).is_file():
            shutil.copyfile(base / name, draft / name)
    environment = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "commit": commit(),
        "packages": _installed(),
    }
    text = json.dumps(environment, indent=1, sort_keys=True)
    (draft / "environment.json").write_text(text + "\n", encoding="utf-8")
    return environment
