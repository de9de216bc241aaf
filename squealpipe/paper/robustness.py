"""Robustness of each verdict: the paper's statements with damping, other laws, other starts."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from squealpipe.paper.inference.candidates import Candidates
from squealpipe.paper.inference.consequences import CONSEQUENCES, judge_consequences
from squealpipe.paper.inference.constraints import (
    Stage,
    measure,
    registered_constraints,
)
from squealpipe.paper.schema.inference import of_study
from squealpipe.paper.schema.robustness import verdict_robustness_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.substitutes import critical_damping
from squealpipe.validation import Natural, Seed, Tolerance, Workers
from squealpipe.vibration.shares import wilson_interval

Share = tuple[float, float, float, int, int]
"""Share of sets, its lower and upper bound, how many were judged, and the outcome."""


def variants(params: Parameters) -> Iterator[tuple[str, Parameters]]:
    """(name, parameters) of the variants that start at rest."""
    yield "as configured", params
    unit = [critical_damping(k, params.mass) for k in (params.k1, params.k2)]
    # c/(2 √(k m)) of each spring
    damping_ratios = (0.005, 0.02, 0.05)
    for ratio in damping_ratios:
        yield (
            f"damping ratio {100 * ratio:g} %",
            params.with_(damping1=ratio * unit[0], damping2=ratio * unit[1]),
        )
    yield (
        "damping 2 %, spring 1 only",
        params.with_(damping1=0.02 * unit[0], damping2=0.0),
    )
    yield (
        "damping 2 %, spring 2 only",
        params.with_(damping1=0.0, damping2=0.02 * unit[1]),
    )
    # slow, middle and fast belt, over the speed v0 by which friction falls
    belt_speeds = (1.0, 10.0, 100.0)
    # static over sliding friction of the two falling laws
    static_ratio = 2.0
    for law in ("exponential", "hyperbolic"):
        for speed in belt_speeds:
            yield (
                f"{law} law, |V| = {speed:g} v₀",
                params.with_(
                    friction_law=law,
                    mu_static=static_ratio * params.mu,
                    friction_speed=abs(params.belt_speed) / speed or 1.0,
                ),
            )
    for factor, words in ((2.0, "double"), (0.5, "half")):
        yield f"{words} κ", params.with_(k3=factor * params.k3)
        lengths = {
            name: factor * getattr(params, name) for name in ("length1", "length2")
        }
        yield f"{words} λ", params.with_(**lengths)


@recorded(model="A1, A2, A3", method="margins of the statements")
def verdict_robustness(
    params: Parameters,
    *,
    starts: Natural,
    inferred: xr.Dataset | None = None,
    seed: Seed = 1,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Return whether each statement of Figs. 2 to 9 holds, setting by setting.

    Statements are those of the inference, with its criteria and thresholds; starts at rest, but for
    the last variants, where a share of random starts is given with its 95 % interval (Wilson).

    Args:
        inferred: dataset ``parameter_inference``; its feasible parameter sets become a variant, in
            which statements that were fitted are not judged, for they hold by construction.
    """
    names = [constraint.name for constraint in registered_constraints] + list(
        CONSEQUENCES
    )
    named = list(variants(params))
    titles = [title for title, _ in named]
    rows = _verdicts_of([each for _, each in named], names, tol, workers)
    generator = np.random.default_rng(seed)
    speed = params.preload / params.time_unit
    # largest distance of a start from rest, over l_pre, and of its velocity, over l_pre √(k1/m)
    distances = (0.01, 0.1)
    for near in distances:
        fields = {
            key: np.full(starts, value) for key, value in params.as_dict().items()
        }
        size = near * np.array([params.preload, params.preload, speed, speed])
        state = generator.uniform(-1.0, 1.0, (starts, 4)) * size
        candidates = Candidates(
            fields, tol, workers, initial_state=state, exact=False, sampled=True
        )
        verdicts = _margins(
            candidates, set(Stage) - {Stage.printed, Stage.black, Stage.maps}
        )  # maps are of starts at rest
        for constraint in registered_constraints:
            if constraint.stage == Stage.linear:  # one setting however it starts
                holds, judged = verdicts[constraint.name]
                verdicts[constraint.name] = holds[:1], judged[:1]
        rows.append([_share(*verdicts.get(name, (None, None))) for name in names])
        titles.append(f"starts within {100 * near:g} % of l_pre")
    if inferred is not None:
        rows.insert(1, _feasible(of_study(inferred), names))
        titles.insert(1, "feasible parameters")
    statement_columns = ("share", "share_low", "share_high", "judged", "outcome")
    columns = dict(
        zip(statement_columns, np.moveaxis(np.array(rows), -1, 0), strict=True)
    )
    return build(
        verdict_robustness_schema, columns, {"variant": titles, "statement": names}
    )


def _verdicts_of(
    settings: Sequence[Parameters],
    names: Sequence[str],
    tol: float,
    workers: int | None,
) -> list[list[Share]]:
    """A row of shares for each setting; those that have the same parameters run side by side."""
    rows: list[list[Share]] = [[] for _ in settings]
    alike: dict[tuple[str, ...], list[int]] = {}
    for i, params in enumerate(settings):
        alike.setdefault(tuple(params.as_dict()), []).append(i)
    for places in alike.values():
        some = Candidates.of(*(settings[i] for i in places), tol=tol, workers=workers)
        some = replace(some, exact=False)
        verdicts = _margins(some)
        held = judge_consequences(some).items()
        verdicts |= {name: (values, np.ones(some.size, bool)) for name, values in held}
        for k, i in enumerate(places):
            rows[i] = [
                _share(*(verdict[[k]] for verdict in verdicts[n])) for n in names
            ]
    return rows


def _margins(
    candidates: Candidates, stages: Iterable[Stage] = Stage
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Statement → (holds, could be judged)."""
    return {
        name: (measured.margin > 0.0, np.isfinite(measured.margin))
        for name, measured in measure(candidates, stages).items()
    }


def _feasible(inferred: xr.Dataset, names: list[str]) -> list[Share]:
    """The row of the inferred parameter sets: what was predicted of them."""
    count = int(inferred.feasible_count)
    rows = []
    for name in names:
        if name not in inferred.consequence.values:
            rows.append(_share(None, None))
            continue
        held = round(
            float(inferred.feasible_share.sel(consequence=name).fillna(0.0)) * count
        )
        rows.append(_share(np.arange(count) < held, np.ones(count, bool)))
    return rows


def _share(holds: np.ndarray | None, judged: np.ndarray | None) -> Share:
    """(share, its interval, number judged, outcome)."""
    if holds is None or judged is None:
        return math.nan, math.nan, math.nan, 0, Outcome.not_computed
    number, count = int(judged.sum()), int((holds & judged).sum())
    if not number:
        return math.nan, math.nan, math.nan, 0, Outcome.unresolved
    if number == 1:
        return float(count), float(count), float(count), 1, Outcome.converged
    return count / number, *wilson_interval(count, number), number, Outcome.converged
