"""What stands behind each share and each fitted number: its sample, error and convergence.

A share of a random sample (parameter sets, runs from perturbed starts) has Wilson's interval. A
share of a map is an area: its error is the change from every second line, at least one cell, and
the change from every fourth to every second tells how it converges. A fit has its standard error,
and is made again with half of its points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from math import isfinite
from typing import Any

import numpy as np
import scipy.stats
import xarray as xr

from squealpipe.schema import meanings
from squealpipe.schema.inference import CONFIDENCE, wilson_interval
from squealpipe.schema.ladder import Level
from squealpipe.study.claims.checks.frequencies import LARGE, SMALL, first_is_small, second_is_large
from squealpipe.study.claims.evidence import Run
from squealpipe.study.claims.maps import (
    coupling_is_negative,
    order_turns_over,
    unstable_and_lost,
    unstable_cells,
)
from squealpipe.study.figures.comparison.model_ladder import QUESTION_NAMES
from squealpipe.study.figures.parts.origin import scene_title
from squealpipe.study.figures.parts.style import flag_words
from squealpipe.study.figures.spread.verdict_reach import WORDS
from squealpipe.study.report.facts.linear import turned_by_dashpots
from squealpipe.study.report.facts.orbits import orbit_cells
from squealpipe.text import number

HOW_CONSEQUENCES_CONVERGE = {
    "F7a": "share of the angle map by the midpoint rule, refined from 12 to 24 and 48 angles an "
    "axis where it is near one half",
    "F7_black": "runs around the disc of flutter and along the arcs of divergence, at so many "
    "points that twice as many change less than the interval",
}
"""Consequence of the inference → how it is judged at one parameter set; else in closed form."""

Row = dict[str, Any]


def sampling(run: Run) -> dict[str, Any]:
    """The rows of the appendix, for the datasets that the run has.

    Returns:
        ``confidence`` of the intervals, and ``rows``, each with ``name``, ``dataset``, ``kind``
        ("share", "area" or "fit"), ``value``, ``low`` and ``high`` (value and error, of the unit
        ``unit``; shares and areas lie between 0 and 1), ``sample`` (a number) and ``of`` (of
        what), ``error`` (what low and high are) and ``convergence``, a sentence.
    """
    rows: list[Row] = []
    for name, make in TOPICS.items():
        if name in run:
            rows += [{"dataset": name, **row} for row in make(run)]
    return {"confidence": CONFIDENCE, "rows": rows}


def _share(name: str, held: np.ndarray, of: str, convergence: str = "") -> Row:
    """A share of a random sample; without a word of its own it is compared with its halves."""
    held = np.asarray(held, bool).ravel()
    low, high = wilson_interval(int(held.sum()), held.size)
    if not convergence:
        halves = [float(part.mean()) for part in np.array_split(held, 2) if part.size]
        convergence = "first and second half of the sample: " + " and ".join(
            f"{100 * part:.3g} %" for part in halves
        )
    return {
        "name": name,
        "kind": "share",
        "unit": "1",
        "value": float(held.mean()) if held.size else None,
        "low": low if isfinite(low) else None,
        "high": high if isfinite(high) else None,
        "sample": held.size,
        "of": of,
        "error": f"{100 * CONFIDENCE:.0f} % Wilson interval",
        "convergence": convergence,
    }


def _area(
    name: str, cells: xr.DataArray, among: xr.DataArray | None = None, of: str = "cells"
) -> Row:
    """A share of a map, or of the cells ``among`` that it is asked of."""
    asked = xr.ones_like(cells, bool) if among is None else among
    values = [_share_on(cells, asked, stride) for stride in (4, 2, 1)]
    coarsest, coarse, value = values
    count = int(asked.sum())
    error = max(abs(value - coarse), 1.0 / max(1, count))
    return {
        "name": name,
        "kind": "area",
        "unit": "1",
        "value": value,
        "low": max(0.0, value - error),
        "high": min(1.0, value + error),
        "sample": count,
        "of": of,
        "error": "one cell, or more: the change from every second line of the grid",
        "convergence": "every fourth line, every second, all: "
        + ", ".join(f"{100 * part:.4g} %" for part in (coarsest, coarse, value)),
    }


def _share_on(cells: xr.DataArray, asked: xr.DataArray, stride: int) -> float:
    lines = dict.fromkeys(cells.dims, slice(None, None, stride))
    among = asked.isel(lines)
    count = int(among.sum())
    return float((cells.isel(lines) & among).sum()) / count if count else 0.0


def _inference(run: Run) -> Iterator[Row]:
    inference = run["parameter_inference"]
    yield _share("parameter sets that agree (E9)", inference.feasible.values, "parameter sets")
    for name in inference.statement.values:
        held = inference.holds.sel(statement=name).values
        yield _share(f"{name} holds over the samples", held, "parameter sets")
    count = int(inference.feasible_count)
    for name in inference.consequence.values if count else ():
        row = inference.sel(consequence=name)
        held = np.arange(count) < round(float(row.feasible_share) * count)
        yield _share(
            f"{WORDS.get(str(name), name)} over the feasible set: {row.consequence_check.item()}",
            held,
            "feasible parameter sets",
            HOW_CONSEQUENCES_CONVERGE.get(str(name), "closed form at each parameter set"),
        )


def _stability(run: Run) -> Iterator[Row]:
    regime = run["stability_map"].regime_linear
    yield _area("A3 unstable", unstable_cells(run))
    yield _area("A3 in flutter", regime == 1)
    yield _area("A3 divergent", regime == 2)
    if "quasi_static_map" not in run:
        return
    for allowed, words in (
        (run["quasi_static_map"].possible_as_printed == 1, "that Eq. (11) as printed allows"),
        (run["quasi_static_map"].possible == 1, "with a positive reaction force"),
    ):
        yield _area(f"A3 unstable, of the cells {words} (F6c)", unstable_cells(run), allowed)


def _sliding(run: Run) -> Iterator[Row]:
    sliding = run["quasi_static_map"]
    yield _area("sliding possible by Eq. (11) as printed", sliding.possible_as_printed == 1)
    yield _area("sliding with a positive reaction force", sliding.possible == 1)
    if "stiffness_x" in sliding:
        yield _area("K12 negative (E5)", coupling_is_negative(run))
        yield _area("order of the directions turns over at separation (C1)", order_turns_over(run))


def _validity(run: Run) -> Iterator[Row]:
    yield _area("A1 loses contact (F7a)", run["validity_map"].separates == 1)
    if "stability_map" in run:
        unstable, lost = unstable_and_lost(run)
        yield _area("A3 and A1 agree (F7b)", unstable == lost)


def _frequencies(run: Run) -> Iterator[Row]:
    for state in ("contact", "separated"):
        small, large = first_is_small(run, state), second_is_large(run, state)
        yield _area(f"ω1 below {SMALL:g} of its largest, {state} (F8d)", small)
        yield _area(f"ω2 above {LARGE:g} of its largest, {state} (F9c)", large)


def _critical(run: Run) -> Iterator[Row]:
    turned, saved = turned_by_dashpots(run)
    lowered = run["critical_friction_map"].destabilized == 1
    yield _area("dashpots lower the critical friction", lowered)
    yield _area("dashpots make unstable what is stable without", turned)
    yield _area("dashpots make stable what is unstable without", saved)


def _basin(run: Run, scene: str) -> Iterator[Row]:
    motion = run[f"basin/{scene}"].motion
    for value, name in meanings(motion).items():
        if (motion == value).any():
            words = f"{flag_words(name)} from other starts, {scene_title(scene)}"
            yield _area(words, motion == value, of="starting velocities")


def _propensity(run: Run) -> Iterator[Row]:
    found = run["propensity"]
    for index, name in enumerate(found.quantity.values.tolist()):
        yield {
            "name": f"{flag_words(name)} over the uncertain parameters",
            "kind": "share",
            "unit": "1",
            "value": float(found.share[index]),
            "low": float(found.share_low[index]),
            "high": float(found.share_high[index]),
            "sample": int(found.judged),
            "of": "parameter sets",
            "error": f"{100 * CONFIDENCE:.0f} % Wilson interval",
            "convergence": "from growing parts of the sample: "
            + ", ".join(f"{100 * part:.3g} %" for part in found.share_by_size.values[index]),
        }


def _pull(run: Run) -> Iterator[Row]:
    pull = run["linear_pull"]
    yield _area("the linear model's k3 pulls (F6e)", pull.lowest_contact_force < 0)


def _hammering(run: Run) -> Iterator[Row]:
    hammering = run["hammering_map"]
    strikes = hammering.impact_rate > 0
    yield _area("the mass strikes the belt again (S1)", strikes)
    yield _area(
        "the force exceeds the static preload, of the cells with impacts (S1)",
        hammering.peak_contact_force > 1.0 + 1e-6,
        strikes,
    )
    motion = hammering.motion
    for value, name in meanings(motion).items():
        if (motion == value).any():
            yield _area(f"motion: {flag_words(name)}", motion == value)
    if "motion_later" in hammering:
        yield _area("motion: another label at twice the time", motion != hammering.motion_later)
    limited = hammering.predictability_horizon < hammering.t_end
    yield _area("an error has grown to l_pre/1000 before the end", limited)


def _orbits(run: Run) -> Iterator[Row]:
    atlas = run["orbit_atlas"]
    for mode in atlas.mode.values:
        found, other, unstable = orbit_cells(atlas.sel(mode=mode, drop=True))
        yield _area(f"an orbit of mode {mode} is found", found)
        yield _area(f"orbits of mode {mode} that are off its branch", other, found)
        yield _area(f"orbits of mode {mode} that are unstable", unstable, found)


def _ladder(run: Run) -> Iterator[Row]:
    ladder = run["model_ladder"]
    tolerance = float(ladder.tolerance)
    for name in ladder.question.values:
        errors = ladder.chosen_error.sel(question=name)
        words = QUESTION_NAMES[str(name)].rstrip("?")
        yield _area(
            f"{words}: a level simpler than A1 would do",
            ladder.cheapest.sel(question=name, drop=True) != Level.a1,
        )
        yield _area(
            f"{words}: the chosen model is within the tolerance",
            errors <= tolerance,
            errors.notnull(),
        )


def _transient(run: Run) -> Iterator[Row]:
    lifetimes = run["transient"].shown_lifetime.values / run.parameters.time_unit
    ended = np.isfinite(lifetimes)
    yield _share("runs of Fig. 4 that end in the whirl before the horizon", ended, "runs")
    if "median_lifetime" not in run["transient"]:
        return
    unit = run.parameters.time_unit
    median, low, high = run["transient"].median_lifetime.values / unit
    if not isfinite(high):
        return
    ages = np.where(ended, lifetimes, np.inf)
    halves = [np.quantile(ages[part::2], 0.5, method="inverted_cdf") for part in (0, 1)]
    yield {
        "name": "median lifetime in the scene of Fig. 4",
        "kind": "fit",
        "unit": "√(m/k1)",
        "value": float(median),
        "low": float(low),
        "high": float(high),
        "sample": ended.size,
        "of": "runs, those cut off at the horizon counted as longer",
        "error": f"{100 * CONFIDENCE:.0f} % interval of the Kaplan–Meier estimate",
        "convergence": "every second run and the others: "
        + " and ".join(f"{half:.4g}" for half in halves),
    }


def _refinement(run: Run) -> Iterator[Row]:
    check = run["refinement_check"]
    wrong = (check.different_cells / check.points.astype(float) ** 2).values
    last = check.isel(points=-1)
    told = ", ".join(
        f"{int(points)} ({100 * share:.2g} %)"
        for points, share in zip(check.points.values, wrong, strict=True)
    )
    yield _share(
        "cells of a uniform map that the refined one labels otherwise",
        np.arange(int(last.points) ** 2) < int(last.different_cells),
        f"cells, {int(last.points)} an axis",
        f"on uniform maps of {told} angles an axis",
    )


def _whirl(run: Run) -> Iterator[Row]:
    whirl = run["whirl"]
    inside = whirl.isel(belt_speed=(whirl.fitted == 1).values)
    speeds, sizes = np.abs(inside.belt_speed.values), inside.amplitude.values
    if speeds.size < 6:
        return
    half = speeds.size // 2
    # Least squares of the relative deviation, as the dataset's own.
    line, covariance = np.polyfit(speeds, sizes, 1, w=1 / sizes, cov=True)
    fastest = np.polyfit(speeds[half:], sizes[half:], 1, w=1 / sizes[half:])
    reach = scipy.stats.t.ppf(0.5 + CONFIDENCE / 2, speeds.size - 2) * np.sqrt(np.diag(covariance))
    residual = float(np.abs(np.polyval(line, speeds) / sizes - 1).max())
    for index, (name, unit) in enumerate(
        (("slope of the whirl's size against |V|", "s"), ("its size extrapolated to V = 0", "m"))
    ):
        yield {
            "name": name,
            "kind": "fit",
            "unit": unit,
            "value": float(line[index]),
            "low": float(line[index] - reach[index]),
            "high": float(line[index] + reach[index]),
            "sample": int(speeds.size),
            "of": f"belt speeds from {speeds.min():.3g} to {speeds.max():.3g} m/s",
            "error": f"{100 * CONFIDENCE:.0f} % interval of least squares; largest residual "
            f"{100 * residual:.2g} % of the size",
            "convergence": f"{number(fastest[index], 4)} {unit} from the {speeds.size - half} "
            "fastest of them",
        }


def _harmonic(run: Run) -> Iterator[Row]:
    sweep = run["harmonic_sweep"]
    for key, error, setting in (
        ("omega_rate", "ω", "N_h"),
        ("waveform_rate", "waveform", "N_h"),
        ("sigma_rate", "σ", "σ"),
    ):
        rates = sweep[key].values[np.isfinite(sweep[key].values)]
        if rates.size:
            yield {
                "name": f"convergence exponent of harmonic balance, {error}",
                "kind": "fit",
                "unit": "",
                "value": float(np.median(rates)),
                "low": float(rates.min()),
                "high": float(rates.max()),
                "sample": int(rates.size),
                "of": "fits, one per scene and peak",
                "error": "range over scenes and peaks",
                "convergence": f"the p of an error that falls like {setting}⁻ᵖ",
            }


TOPICS: dict[str, Callable[[Run], Iterator[Row]]] = {
    "parameter_inference": _inference,
    "stability_map": _stability,
    "quasi_static_map": _sliding,
    "validity_map": _validity,
    "linear_pull": _pull,
    "natural_frequencies": _frequencies,
    "critical_friction_map": _critical,
    "hammering_map": _hammering,
    "basin/F2d": partial(_basin, scene="F2d"),
    "basin/F3": partial(_basin, scene="F3"),
    "propensity": _propensity,
    "orbit_atlas": _orbits,
    "harmonic_sweep": _harmonic,
    "model_ladder": _ladder,
    "refinement_check": _refinement,
    "transient": _transient,
    "whirl": _whirl,
}
"""Dataset → the rows that it gives."""
