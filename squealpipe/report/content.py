"""Everything the report says, gathered from the files of one run as plain data."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import netCDF4
from PIL import Image

from squealpipe.claims.evidence import Run
from squealpipe.claims.table import rows
from squealpipe.parameters import Parameters
from squealpipe.report.captions import read_caption, title
from squealpipe.report.facts import gather_facts
from squealpipe.schema.claims import Verdict

TITLE = "Hammering and brake squeal: a paper computed again, statement by statement"

SYMBOLS = {
    "mass": ("m", "mass of the particle"),
    "k1": ("k_1", "stiffness of spring 1"),
    "k2": ("k_2", "stiffness of spring 2"),
    "k3": ("k_3", "stiffness of the contact spring"),
    "mu": ("mu", "Coulomb friction coefficient"),
    "belt_speed": ("V", "speed of the belt"),
    "preload": ('l_"pre"', "precompression of the contact spring"),
    "length1": ("L_1", "free length of spring 1"),
    "length2": ("L_2", "free length of spring 2"),
    "sigma": ("sigma", "regularizing factor of the paper's tanh"),
}
"""Parameter → (symbol as Typst mathematics, meaning)."""


@dataclass(frozen=True, kw_only=True)
class Made:
    """How one file of the run came to be.

    Attributes:
        path: the file.
        rule: name of the workflow rule.
        datasets: names of the datasets that the rule reads.
    """

    path: Path
    rule: str
    datasets: tuple[str, ...] = ()


def gather(
    datasets: Mapping[str, Made],
    figures: Mapping[str, Made],
    parameters: Parameters,
    *,
    explorer: str | None = None,
) -> dict[str, Any]:
    """The report's content; see ``templates/`` for how it is used.

    Args:
        datasets: name (path below ``data/`` without suffix) → NetCDF file.
        figures: name → PNG file.
        parameters: those of the study.
        explorer: link to the explorer page, if the run makes one.
    """
    run = Run(parameters, {name: made.path for name, made in datasets.items()})
    claims = rows(run["claims"]) if "claims" in run else []
    records = {name: _record(name, datasets[name]) for name in sorted(datasets)}
    return {
        "title": TITLE,
        "shipped": parameters == Parameters(),
        "parameters": _parameters(parameters),
        "environment": _environment(datasets),
        "datasets": records,
        "rules": _rules(records),
        "configuration": _configuration(datasets),
        "figures": {name: _picture(name, figures[name], records) for name in sorted(figures)},
        "explorer": explorer,
        "claims": claims,
        "tally": [
            {
                "verdict": verdict.words,
                "ids": [row["id"] for row in claims if row["verdict"] == verdict.words],
            }
            for verdict in Verdict
            if any(row["verdict"] == verdict.words for row in claims)
        ],
        "facts": gather_facts(run),
    }


def picture_files(content: Mapping[str, Any], figures: Mapping[str, Made]) -> dict[str, Path]:
    """Path inside the report's source → PNG file, for each picture of the content."""
    return {item["path"]: figures[name].path for name, item in content["figures"].items()}


def slug(name: str) -> str:
    """A name as an identifier in a page."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def _parameters(parameters: Parameters) -> list[dict[str, Any]]:
    return [
        {
            "symbol": SYMBOLS[name][0],
            "meaning": SYMBOLS[name][1],
            "value": value,
            "unit": Parameters.units(name),
        }
        for name, value in parameters.as_dict().items()
    ]


def _attributes(path: Path) -> dict[str, Any]:
    """Global attributes of a NetCDF file, without its data."""
    with netCDF4.Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def _record(name: str, made: Made) -> dict[str, Any]:
    """One row of the provenance."""
    attributes = _attributes(made.path)
    return {
        "slug": slug(name),
        "rule": made.rule,
        "datasets": list(made.datasets),
        "title": attributes["title"],
        "dataset_id": attributes["dataset_id"],
        "config_hash": attributes["config_hash"],
        "wall_time_s": float(attributes["wall_time_s"]),
        "sha256": hashlib.sha256(made.path.read_bytes()).hexdigest(),
        "bytes": made.path.stat().st_size,
    }


def _rules(records: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rule → its datasets and the time that making them took, longest first."""
    found: dict[str, dict[str, Any]] = {}
    for name, record in records.items():
        row = found.setdefault(
            record["rule"], {"rule": record["rule"], "datasets": [], "seconds": 0.0}
        )
        row["datasets"].append({"name": name, "slug": record["slug"]})
        row["seconds"] += record["wall_time_s"]
    return sorted(found.values(), key=lambda row: -row["seconds"])


def _configuration(datasets: Mapping[str, Made]) -> list[dict[str, str]]:
    """Every configuration value that the datasets were made with, by dotted key."""
    found: dict[str, set[str]] = {}
    for made in datasets.values():
        for key, value in json.loads(_attributes(made.path)["config"]).items():
            for path, leaf in _leaves(key, value):
                found.setdefault(path, set()).add(json.dumps(leaf, ensure_ascii=False))
    return [
        {"key": key, "value": " or ".join(sorted(values))}
        for key, values in sorted(found.items())
        if "." in key
    ]


def _leaves(key: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _leaves(f"{key}.{name}", inner)
    else:
        yield key, value


def _picture(name: str, made: Made, records: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    caption, alt = read_caption(name)
    with Image.open(made.path) as image:
        width = image.width / image.info["dpi"][0]
    return {
        "path": f"pictures/{name}.png",
        "title": title(name),
        "caption": caption,
        "alt": alt,
        "width_inches": width,
        "rule": made.rule,
        "sources": _rules({key: records[key] for key in made.datasets if key in records}),
    }


def _environment(datasets: Mapping[str, Made]) -> list[dict[str, str]]:
    """Version, commit, platform and libraries; several values where the datasets differ."""
    found: dict[str, set[str]] = {"squealpipe": {version("squealpipe")}}
    for made in datasets.values():
        attributes = _attributes(made.path)
        stated = {key: attributes[key] for key in ("commit", "platform")}
        for what, value in {**stated, **json.loads(attributes["libraries"])}.items():
            found.setdefault(what, set()).add(value)
    return [{"what": what, "value": ", ".join(sorted(values))} for what, values in found.items()]


def made_files(table: Mapping[str, Mapping[str, Any]]) -> dict[str, Made]:
    """``Made`` records from the plain table that :mod:`squealpipe.report.lineage` gives."""
    return {
        name: Made(path=Path(row["path"]), rule=row["rule"], datasets=tuple(row["datasets"]))
        for name, row in table.items()
    }
