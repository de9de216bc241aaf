"""Everything the report says, gathered from the files of one run as plain data."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import netCDF4
from PIL import Image

from squealpipe.parameters import TABLE, Parameters
from squealpipe.study.claims.evidence import Run
from squealpipe.study.claims.table import rows
from squealpipe.study.figures import declared
from squealpipe.study.report.facts import gather_facts
from squealpipe.study.report.places import FIGURES, PLACES
from squealpipe.study.report.summary import PAPER, is_misprint, summarize, tally
from squealpipe.text import RAISED

TITLE = "Hammering and brake squeal: a paper computed again, statement by statement"


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
    beyond_paper: bool = False,
    explorer: str | None = None,
    animations: Mapping[str, str] | None = None,
    page: Path | None = None,
) -> dict[str, Any]:
    """The report's content; see ``templates/`` for how it is used.

    Args:
        datasets: name (path below ``data/`` without suffix) → NetCDF file.
        figures: name → PNG file.
        parameters: those of the study.
        beyond_paper: it has dashpots or friction other than Coulomb's, which A4 cannot carry.
        explorer: link to the explorer page, if the run makes one.
        animations: what each shows → its GIF.
        page: where the page will be; then it links the PDF beside it and each dataset.
    """
    run = Run(parameters, {name: made.path for name, made in datasets.items()})
    claims = rows(run["claims"]) if "claims" in run else []
    records = {name: _record(name, datasets[name]) for name in sorted(datasets)}
    facts = gather_facts(run)

    def link(path: str | Path) -> str | None:
        return None if page is None else os.path.relpath(path, page.parent)

    return {
        "title": TITLE,
        "paper": PAPER,
        "summary": summarize(claims, facts, figures),
        "shipped": parameters == Parameters(),
        "parameters": _parameters(parameters),
        "one_pivot": parameters.length1 == parameters.length2,
        "belt_along_x": parameters.belt_direction > 0,
        "beyond_paper": beyond_paper,
        "environment": _environment(datasets),
        "datasets": {
            name: {**record, "link": link(datasets[name].path)} for name, record in records.items()
        },
        "rules": _rules(records),
        "configuration": _configuration(datasets),
        "places": PLACES,
        "figures": {
            name: _picture(name, figures[name], records, run) for name in FIGURES if name in figures
        },
        "explorer": explorer,
        "pdf": None if page is None else "report.pdf",
        "animations": [
            {"what": what, "link": link(path)} for what, path in (animations or {}).items()
        ],
        "claims": claims,
        "statements": {
            "rows": (judged := [row for row in claims if not is_misprint(row)]),
            "tally": tally(judged),
        },
        "misprints": {
            "rows": (printed := [row for row in claims if is_misprint(row)]),
            "tally": tally(printed),
        },
        "facts": facts,
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
            "symbol": TABLE[name].symbol,
            "meaning": TABLE[name].meaning,
            "value": value,
            "unit": re.sub(r"-\d", lambda found: found[0].translate(RAISED), TABLE[name].units),
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


def title(name: str) -> str:
    """Heading of a picture: the paper's number, or the name in words."""
    paper = re.fullmatch(r"fig(\d+)", name)
    if paper:
        return f"Fig. {int(paper[1])}."
    words = name.replace("_", " ").capitalize()
    return re.sub(r"\ba\d\b", lambda level: level[0].upper(), words) + "."


def _picture(
    name: str, made: Made, records: Mapping[str, Mapping[str, Any]], run: Run
) -> dict[str, Any]:
    caption, alt = declared.texts(name, run)
    with Image.open(made.path) as image:
        width, aspect = image.width / image.info["dpi"][0], image.height / image.width
    return {
        "path": f"pictures/{name}.png",
        "title": title(name),
        "caption": caption,
        "alt": alt,
        "width_inches": width,
        "aspect": aspect,
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
    """``Made`` records from the plain table that :mod:`squealpipe.study.report.lineage` gives."""
    return {
        name: Made(path=Path(row["path"]), rule=row["rule"], datasets=tuple(row["datasets"]))
        for name, row in table.items()
    }
