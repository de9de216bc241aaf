"""Contents of the report of a study of one's own, as plain data."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.brake.schema.assess import KICKS
from squealpipe.brake.schema.dynamics.intervals import intervals
from squealpipe.codes import Regime, Verdict, flag_words
from squealpipe.parameters import Parameters
from squealpipe.store import load
from squealpipe.study.evidence import Evidence
from squealpipe.study.report import answer
from squealpipe.study.report.answer_content import answer_content
from squealpipe.study.report.media import media_of
from squealpipe.study.report.parts import Made, changed_rows, parameter_table, pictures
from squealpipe.study.report.sections import OWN
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number, percent


def gather_own(
    datasets: Mapping[str, Made],
    figures: Mapping[str, Made],
    parameters: Parameters,
    changed: Sequence[tuple[str, Any, Any]] = (),
    left_out: Sequence[str] = (),
    became: Sequence[str] = (),
) -> dict[str, Any]:
    """Content of ``templates/study.typ``.

    Args:
        changed: keys of grids and horizons that are not as shipped, with both values.
        left_out: parts of the study that its laws cannot have, in words.
        became: what inputs that stand for parameters became, in words.
    """
    run = Evidence(parameters, {name: made.path for name, made in datasets.items()})
    names = [
        name.removeprefix("assess/") for name in datasets if name.startswith("assess/")
    ]
    return {
        "title": "Does it squeal? Report of a brake",
        "words": {each.name: each.words for each in Verdict},
        "changed": changed_rows(changed),
        "left_out": list(left_out),
        "became": list(became),
        "parameters": parameter_table(parameters, of_a1=True),
        "figures": pictures(OWN, figures, run),
        "scenes": [
            scene(name, run[f"assess/{name}"], run[f"own/{name}"]) for name in names
        ],
        "strikes": _strikes(parameters),
        "scatter": _scatter(run),
    }


def media_of_scenes(datasets: Mapping[str, Made]) -> dict[str, str]:
    """Film and sound of each scene whose motion lasts, by its name, as elements of the page."""
    media = {}
    for name, made in datasets.items():
        room, _, scene_name = name.partition("/")
        if room != "assess":
            continue
        told = load(made.path)
        if answer.verdict_of(told) is Verdict.quiet:
            continue
        if np.isfinite(told.path_x.values).all():
            longer = datasets.get(f"settled/{scene_name}")
            heard = [] if longer is None else [load(longer.path)]
            media[scene_name] = media_of(scene_name, told, heard)
    return media


def scene(name: str, told: xr.Dataset, started: xr.Dataset) -> dict[str, Any]:
    """The answer of one scene in words, and its tables.

    Args:
        told: its dataset ``assess``.
        started: its run from its own start.
    """
    return {
        "name": name,
        "angles": [number(float(np.degrees(told[f"alpha{i}"]))) for i in (1, 2)],
        **answer_content(told),
        "snaps": answer.snap_throughs(told),
        "nearest": _nearest(told),
        "start": _from_start(started),
    }


def _nearest(told: xr.Dataset) -> str | None:
    """Describe where the nearest other verdict lies in the plane of both angles."""
    now = [math.degrees(float(told[f"alpha{i}"])) for i in (1, 2)]
    there = [math.degrees(float(told[f"quiet_alpha{i}"])) for i in (1, 2)]
    if not np.isfinite(there).all():
        return None
    moves = [b - a for a, b in zip(now, there, strict=True)]
    away = number(math.hypot(*moves), 2)
    how = ", ".join(
        f"alpha{i} {number(angle)}° ({'+' if move > 0 else '−'}{number(abs(move), 2)}°)"
        for i, (angle, move) in enumerate(zip(there, moves, strict=True), start=1)
    )
    return f"{how}: {away}° away"


def _strikes(parameters: Parameters) -> str:
    """The speeds that strikes give the pad, in words."""
    rate = math.sqrt((parameters.k1 + parameters.k2) / (2.0 * parameters.mass))
    speeds = [parameters.preload * rate * math.hypot(*kick) for kick in KICKS]
    least, most = (engineering(end(speeds), "m s-1", 2) for end in (min, max))
    return f"{least} to {most}"


def _from_start(run: xr.Dataset) -> dict[str, str]:
    """Describe the run from the scene's own start."""
    apart = intervals(run, Regime.separated)
    return {
        "first_loss": engineering(float(apart[0, 0]), "s") if len(apart) else "none",
        "end": engineering(float(run.time_reached), "s"),
    }


def _scatter(run: Evidence) -> dict[str, Any] | None:
    """Shares of the verdicts over configured distributions; None where none are."""
    if "verdict_shares" not in run:
        return None
    shares = run["verdict_shares"]
    distributions = json.loads(shares.attrs["arguments"])["distributions"]
    return {
        "samples": int(shares.samples),
        "distributions": [
            {"name": name, "words": _distribution(each)}
            for name, each in distributions.items()
        ],
        "shares": [
            {
                "what": flag_words(str(value)),
                "share": percent(float(of_kind.share)),
                "interval": f"{percent(float(of_kind.share_low))} to "
                f"{percent(float(of_kind.share_high))}",
            }
            for value in shares.kind.values
            for of_kind in [shares.sel(kind=value)]
        ],
    }


def _distribution(entry: Mapping[str, Any]) -> str:
    numbers = [
        f"{key.replace('_', ' ')} {number(value)}"
        for key, value in entry.items()
        if key != "distribution"
    ]
    return ", ".join([str(entry["distribution"]), *numbers])
