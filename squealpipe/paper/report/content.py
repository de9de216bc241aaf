"""Contents of the paper's report, gathered from the files of one run as plain data."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from squealpipe.paper.claims.table import rows, tally
from squealpipe.paper.figures.dynamics import regime_charts
from squealpipe.paper.report import edited, sections
from squealpipe.paper.report.numbers import numbers
from squealpipe.paper.schema.claims import ClaimVerdict, Origin
from squealpipe.parameters import Parameters
from squealpipe.study.evidence import Evidence
from squealpipe.study.report.parts import Made, changed_rows, parameter_table, pictures

CITED_PAPER = {
    "authors": "O. T. Şen and R. Singh",
    "title": "Dynamics of a simplified nonlinear model offering insights into the hammering type "
    "brake squeal initiation process",
    "journal": "Noise Control Engineering Journal",
    "year": 2021,
}
"""The paper that is computed again."""


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

    title = "Hammering and brake squeal: a paper computed again, statement by statement"
    return {
        "title": title,
        "paper": CITED_PAPER,
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
        "methods": _sections(sections.METHOD_SECTIONS),
        "beyond": _sections(sections.BEYOND_THE_PAPER),
        "supplement": _sections(sections.SUPPLEMENT),
        "figures": pictures(sections.PAPER_FIGURES, figures, run),
        "datasets": {name: link(made.path) for name, made in sorted(datasets.items())},
        "links": [
            {"words": words, "to": link(to)} for words, to in (links or {}).items()
        ],
        "statements": papers,
        "misprints": [row for row in claims if row["origin"] == Origin.misprints.name],
    }


def levels(run: Evidence) -> list[list[str]]:
    """The paper's Table 1, with the scenes in which each assumption held along the motion."""
    if "assumptions" not in run:
        return []
    table = run["assumptions"]
    written = []
    # The paper's Table 1: level → nonlinearities, assumptions, use
    rows = {
        "A1": (
            "friction, kinematic and clearance",
            "–",
            "time histories, Figs. 2–5, 7",
        ),
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
    for level, words in rows.items():
        at_level = table.sel(level=level)
        needed = [
            name
            for name in at_level.assumption.values
            if at_level.needed.sel(assumption=name)
        ]
        held = "; ".join(
            f"{name} in {int(at_level.held.sel(assumption=name).sum())}"
            for name in needed
        )
        written.append([level, *words, f"{held} of {table.sizes['scene']}"])
    return written


def distances(run: Evidence) -> dict[str, Any] | None:
    """The table beside the charts of regimes, None where the study has none."""
    names = [name for name in run if name.startswith("friction_chart/")]
    if "angle_chart" not in run or not names:
        return None
    charts = {name: run[name] for name in names}
    return regime_charts.distances(run["angle_chart"], charts)


def _sections(parts: Mapping[str, sections.ReportSection]) -> list[dict[str, Any]]:
    return [{"id": name, **part._asdict()} for name, part in parts.items()]
