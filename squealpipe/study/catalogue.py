"""Catalogue of runs: archives and folders of results, searched by their parameters."""

import json
import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squealpipe.laws.friction_laws import COULOMB
from squealpipe.parameters import DEFAULTS, SYMBOLS, TABLE, Parameters
from squealpipe.store.runs import dataset_files, read_manifest, refuse_copy, verify
from squealpipe.store.sealed import attributes
from squealpipe.store.whole_files import ARCHIVES, MANIFEST
from squealpipe.store.yaml_files import flat
from squealpipe.study.configuration.settings import PAPER, Study, read_study
from squealpipe.systems.inputs.words import nearest


@dataclass(frozen=True, kw_only=True)
class StoredRun:
    """One archive or folder of results.

    Attributes:
        date: when it was frozen, or its last dataset made, ISO.
        commit: of the code that froze or made it; empty if not stated.
        config: dotted key → value of what made it.
        faults: what is wrong with it, file by file; none: it is intact.
        finished: whether the last of its results, the report, is there.
    """

    name: str
    date: str
    commit: str
    size: int
    config: dict[str, Any] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    finished: bool = True

    def changed(self, paper: dict[str, Any]) -> dict[str, Any]:
        """Configuration keys whose values are not the paper's."""
        return {
            key: value
            for key, value in self.config.items()
            if key != "results"
            and paper.get(key) != value  # which says where, not what
        }


def runs(root: str | os.PathLike[str] = ".") -> list[StoredRun]:
    """All archives and folders of results of a checkout, by name; each file is verified."""
    base = Path(root)
    archives = base / ARCHIVES
    frozen = [at for at in sorted(archives.glob("[!.]*")) if (at / MANIFEST).is_file()]
    folders = [archives.parent, *sorted(archives.parent.glob("[!.]*"))]
    made = [at for at in folders if at != archives and any((at / "data").rglob("*.nc"))]
    return [*map(_archived, frozen), *(_results(at, base) for at in made)]


def matching(expression: str, stored_runs: list[StoredRun]) -> list[str]:
    """Names of the runs whose parameters fulfil a condition, as pandas reads it.

    Names are parameters (``mu``, ``length1``), the paper's symbols (``L1``), or keys of the
    configuration with their section (``linear.points``). Where a table stands for a parameter,
    its value is meant; no condition holds of the static coefficient of a law in Python.
    """
    import pandas as pd  # half of the time of a list, which needs no condition

    known = [run for run in stored_runs if run.config]
    rows = [_row(run.config) for run in known] or [_row({})]
    text = re.sub(r"\b[a-z]\w*(\.\w+)+", lambda key: f"`{key[0]}`", expression)
    example = "write for instance 'mu == 0.25 and L1 > 4'"
    try:
        holds = pd.DataFrame(rows).eval(text, engine="python")
    except Exception as error:
        unknown = re.search(r"name '(\w+)' is not defined", str(error))
        near = nearest(unknown[1], list(rows[0])) if unknown else None
        hint = f"; did you mean {near!r}?" if near else ""
        raise ValueError(f"{expression!r}: {error}{hint}; {example}") from error
    if not isinstance(holds, pd.Series) or holds.dtype.kind != "b":
        raise ValueError(
            f"{expression!r}: it is not a condition that is true or false; {example}"
        )
    return [run.name for run, held in zip(known, holds, strict=False) if held]


def _row(config: dict[str, Any]) -> dict[str, Any]:
    """A run's values by the names that a condition may use, defaults where it states none."""
    values = {**flat(Study().model_dump(mode="json")), **config}
    row = _as_computed(
        {name: values.get(f"parameters.{name}", DEFAULTS[name]) for name in TABLE}
    )
    row |= {symbol: row[name] for symbol, name in SYMBOLS.items() if symbol not in row}
    return row | {
        key: value for key, value in values.items() if "parameters." not in key
    }


def _as_computed(stated: dict[str, Any]) -> dict[str, Any]:
    """Parameters with what the tables of laws make of them, and the static coefficient.

    A law in Python is not run, for the run may be somebody else's: its static coefficient is
    NaN, unless it is stated.
    """
    in_python = "\n" in stated["friction_law"]
    readable = {"friction_law": COULOMB, "mu_static": None} if in_python else {}
    params = Parameters(**{**stated, **readable})
    static = math.nan if stated["mu_static"] is None else stated["mu_static"]
    return {
        **vars(params),
        "friction_law": stated["friction_law"],
        "mu_static": static if in_python else params.static_mu,
    }


def paper_configuration() -> dict[str, Any]:
    """Dotted key → value of the paper's study."""
    return flat(read_study(PAPER).model_dump(mode="json"))


def _archived(place: Path) -> StoredRun:
    manifest = read_manifest(place)
    config = manifest.get("config")
    return StoredRun(
        name=place.name,
        date=str(manifest.get("frozen", "")),
        commit=str(manifest.get("commit", "")),
        size=sum(path.stat().st_size for path in place.rglob("*") if path.is_file()),
        config=flat(config) if isinstance(config, dict) else {},
        faults=verify(place).findings,
    )


def _results(place: Path, base: Path) -> StoredRun:
    """A run that is going on or was edited: what can be read of it, and which files cannot."""
    config: dict[str, Any] = {}
    commits, dates, faults = {""}, [""], []
    files = dataset_files(place)
    for name, path in files.items():
        try:
            stated = attributes(path)
            refuse_copy(name, path, stated)
        except ValueError as error:
            faults.append(str(error))
            continue
        part = json.loads(stated.get("config", "{}"))
        recorded = flat(
            {key: part[key] for key in part if key in Study.model_fields or "." in key}
        )
        mixed = [
            key for key in recorded if config.get(key, recorded[key]) != recorded[key]
        ]
        faults += [
            f"{path}: {key} = {recorded[key]}, elsewhere {config[key]}" for key in mixed
        ]
        config |= recorded
        commits.add(str(stated.get("commit", "")))
        dates.append(str(stated.get("history", "")).partition(" ")[0])
    return StoredRun(
        name=place.relative_to(base).as_posix(),
        date=max(dates),
        commit=", ".join(sorted(commits - {""})),
        size=sum(path.stat().st_size for path in files.values() if path.is_file()),
        config=config,
        faults=faults,
        finished=(place / "report/index.html").is_file(),
    )
