"""What the pages show, gathered from the files of one run as plain data."""

import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from PIL import Image

from squealpipe.parameters import TABLE, Parameters, law_in_words
from squealpipe.schema.claims import ClaimVerdict, Origin
from squealpipe.store.sealed import attributes
from squealpipe.store.whole_files import checksum
from squealpipe.study.claims.evidence import Evidence
from squealpipe.study.claims.table import rows, tally
from squealpipe.study.figures import declared
from squealpipe.study.figures.dynamics import regime_charts
from squealpipe.study.report import edited, sections
from squealpipe.study.report.numbers import numbers
from squealpipe.units import shown_in

TITLE = "Hammering and brake squeal: a paper computed again, statement by statement"
PAPER = {
    "authors": "O. T. Şen and R. Singh",
    "title": "Dynamics of a simplified nonlinear model offering insights into the hammering type "
    "brake squeal initiation process",
    "journal": "Noise Control Engineering Journal",
    "year": 2021,
}
"""The paper that is computed again."""


@dataclass(frozen=True, kw_only=True)
class Made:
    """How one file of the run came to be."""

    path: Path
    rule: str
    datasets: tuple[str, ...] = ()


def gather(
    datasets: Mapping[str, Made],
    figures: Mapping[str, Made],
    parameters: Parameters,
    *,
    reading: str = "as_printed",
    changed: Sequence[tuple[str, Any, Any]] = (),
    links: Mapping[str, str | Path] | None = None,
    page: Path | None = None,
) -> dict[str, Any]:
    """Content of the paper's report and of its supplement; see ``templates/``.

    Args:
        reading: how the paper's sign of friction is read.
        changed: keys of the configuration that differ from the shipped one, with both values. The
            narrative is shown only where there are none.
    """
    run = Evidence(parameters, {name: made.path for name, made in datasets.items()})
    claims = rows(run["claims"]) if "claims" in run else []
    papers = [row for row in claims if row["origin"] != Origin.misprints.name]

    def link(path: str | Path) -> str | None:
        return None if page is None else os.path.relpath(path, page.parent)

    return {
        "title": TITLE,
        "paper": PAPER,
        "shipped": not changed,
        "friction": edited.friction_in_words(parameters, reading),
        "edit": edited.what_changed(changed),
        "changed": changed_rows(
            sorted(changed, key=lambda row: not edited.is_physical(row[0]))
        ),
        "undecided": edited.undecided(claims),
        "tally": tally(papers),
        "levels": levels(run),
        "distances": distances(run),
        "changed_verdicts": [
            {
                "id": row["id"],
                "statement": row["statement"],
                "shipped": row["recorded"],
                "here": row["verdict_here"],
            }
            for row in claims
            if not row["as_recorded"]
            and row["verdict_here"] != ClaimVerdict.cannot_be_decided.words
        ],
        "numbers": {} if changed else numbers(run),
        "parameters": parameter_table(parameters),
        "compared": _sections(sections.COMPARED),
        "methods": _sections(sections.METHODS),
        "beyond": _sections(sections.BEYOND),
        "supplement": _sections(sections.SUPPLEMENT),
        "figures": pictures(sections.FIGURES, figures, run),
        "datasets": {name: link(made.path) for name, made in sorted(datasets.items())},
        "links": [
            {"words": words, "to": link(to)} for words, to in (links or {}).items()
        ],
        "statements": papers,
        "misprints": [row for row in claims if row["origin"] == Origin.misprints.name],
    }


def provenance(
    datasets: Mapping[str, Made], figures: Mapping[str, Made]
) -> dict[str, Any]:
    """Rules, ids, checksums, times, configuration and environment of a run, for a file."""
    records: dict[str, dict[str, Any]] = {}
    configuration: dict[str, Any] = {}
    environment: dict[str, set[str]] = {"squealpipe": {version("squealpipe")}}
    for name, made in sorted(datasets.items()):
        stated = attributes(made.path)
        records[name] = {
            "rule": made.rule,
            "made_from": list(made.datasets),
            "sha256": checksum(made.path),
            **{
                key: stated[key]
                for key in ("title", "dataset_id", "config_hash", "wall_time_s")
                if key in stated
            },
        }
        configuration |= json.loads(stated.get("config", "{}"))
        made_with = {key: stated.get(key, "unknown") for key in ("commit", "platform")}
        made_with |= json.loads(stated.get("libraries", "{}"))
        for what, value in made_with.items():
            environment.setdefault(what, set()).add(value)
    return {
        "datasets": records,
        "figures": {
            name: {"rule": made.rule, "datasets": list(made.datasets)}
            for name, made in figures.items()
        },
        "configuration": configuration,
        "environment": {what: sorted(values) for what, values in environment.items()},
    }


def pictures(
    names: Sequence[str], figures: Mapping[str, Made], run: Mapping[str, Any]
) -> dict[str, Any]:
    """Name → what a page needs of each picture that the run has."""
    return {
        name: _picture(name, figures[name], run) for name in names if name in figures
    }


def picture_files(
    content: Mapping[str, Any], figures: Mapping[str, Made]
) -> dict[str, Path]:
    """Path inside the report's source → PNG file, for each picture of the content."""
    return {
        item["path"]: figures[name].path for name, item in content["figures"].items()
    }


def parameter_table(
    parameters: Parameters, *, of_a1: bool = False
) -> list[dict[str, Any]]:
    """Symbol, meaning, value and unit of each parameter, or of those that enter A1 alone.

    A parameter for which the file of a law stands has no row.
    """
    rows = []
    for name, value in parameters.as_dict().items():
        row = TABLE[name]
        if name in parameters.in_laws or (of_a1 and not row.enters_a1):
            continue
        shown, unit = value, ""
        if row.laws:
            shown = law_in_words(value, row.laws.TABLE_UNITS)
        elif value is not None:
            factor, unit = shown_in(value, row.units)
            shown = value * factor
        meaning = row.meaning.partition(":")[0] if row.laws else row.meaning
        rows.append(
            {"symbol": row.symbol, "meaning": meaning, "value": shown, "unit": unit}
        )
    return rows


TABLE_1 = {
    "A1": ("friction, kinematic and clearance", "–", "time histories, Figs. 2–5, 7"),
    "A2": (
        "linearized",
        "angles do not change; surface separation is ignored",
        "quasi-static sliding, Fig. 6",
    ),
    "A3": (
        "linearized and nondimensional",
        "angles do not change; surface separation is ignored",
        "dynamic stability, Fig. 6",
    ),
    "A4": (
        "clearance alone",
        "angles do not change; the friction nonlinearity is ignored",
        "frequency responses, Figs. 8–13",
    ),
}
"""The paper's Table 1: level → nonlinearities, assumptions, use."""


def levels(run: Evidence) -> list[list[str]]:
    """The paper's Table 1, with the scenes in which each assumption held along the motion."""
    if "assumptions" not in run:
        return []
    table = run["assumptions"]
    written = []
    for level, words in TABLE_1.items():
        at_level = table.sel(level=level)
        needed = [
            name
            for name in at_level.assumption.values
            if at_level.needed.sel(assumption=name)
        ]
        held = "; ".join(
            f"{name}: {int(at_level.held.sel(assumption=name).sum())}"
            for name in needed
        )
        written.append([level, *words, f"{held}; of {table.sizes['scene']}"])
    return written


def distances(run: Evidence) -> dict[str, Any] | None:
    """The table beside the charts of regimes, None where the study has none."""
    names = [name for name in run if name.startswith("friction_chart/")]
    if "angle_chart" not in run or not names:
        return None
    charts = {name: run[name] for name in names}
    return regime_charts.distances(run["angle_chart"], charts)


def title(name: str) -> str:
    """Heading of a picture: the paper's number, or the name in words."""
    if paper := re.fullmatch(r"fig(\d+)(?:_to_(\d+))?", name):
        first, last = int(paper[1]), paper[2]
        return f"Figs. {first}–{int(last)}." if last else f"Fig. {first}."
    words = name.removeprefix("own_").replace("_", " ").capitalize()
    return re.sub(r"\ba\d\b", lambda level: level[0].upper(), words) + "."


def made_files(table: Mapping[str, Mapping[str, Any]]) -> dict[str, Made]:
    """``Made`` records from the plain table that :mod:`squealpipe.study.report.lineage` gives."""
    return {
        name: Made(
            path=Path(row["path"]), rule=row["rule"], datasets=tuple(row["datasets"])
        )
        for name, row in table.items()
    }


def _sections(parts: Mapping[str, sections.ReportSection]) -> list[dict[str, Any]]:
    return [{"id": name, **part._asdict()} for name, part in parts.items()]


def _picture(name: str, made: Made, run: Mapping[str, Any]) -> dict[str, Any]:
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
        "datasets": list(made.datasets),
    }


def changed_rows(changed: Sequence[tuple[str, Any, Any]]) -> list[dict[str, str]]:
    """Rows of a table of keys of the configuration, the shipped value and that of this study."""
    return [
        {"key": key, "shipped": _written(shipped), "here": _written(here)}
        for key, shipped, here in changed
    ]


def _written(value: Any) -> str:
    return "–" if value is None else json.dumps(value, ensure_ascii=False).strip('"')
