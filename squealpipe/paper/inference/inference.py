"""Inference of the parameters, and of the reading of friction's sign, that agree with the paper.

The paper prints no numbers. Equal springs are assumed (Fig. 5 and the isolated x mode of Fig. 12
need them); κ, μ, λ and v are left.
"""

from __future__ import annotations  # help shows Angle, not its checks

from typing import Annotated, Any

import numpy as np
import scipy
import xarray as xr
from pydantic import Strict

from squealpipe.brake.models.refusals import refuse_extensions
from squealpipe.paper.inference.candidates import Candidates, sets_of
from squealpipe.paper.inference.consequences import CONSEQUENCES, judge_consequences
from squealpipe.paper.inference.constraints import (
    Stage,
    judge,
    measure,
    registered_constraints,
)
from squealpipe.paper.schema.inference import Holds, parameter_inference_schema
from squealpipe.parameters import Parameters
from squealpipe.reading import READINGS, reading_of
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import Natural, Number, Seed, Tolerance, Workers
from squealpipe.vibration.shares import wilson_interval

Range = Annotated[
    tuple[Number, Number], Strict(strict=False)
]  # a list of a configuration too

FULLY_JUDGED = 1 / 16
"""The first samples, this share of them, are judged until a second statement refutes them: by these
it is known what a statement excludes alone, but for the last one, of which all samples tell it. The
first ones of Halton's points cover the ranges evenly; every eighth of them would not, since they
share three digits of κ."""


@recorded(
    model="A1", method="Taylor series with located events over quasi-random samples"
)
def infer_parameters(
    params: Parameters,
    *,
    samples: Natural,
    reading: str = "as_printed",
    kappa: Range = (0.3, 1.3),
    mu: Range = (0.02, 0.8),
    length_ratio: Range = (2.0, 100.0),
    speed_ratio: Range = (0.1, 316.0),
    seed: Seed = 2021,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Judge quasi-random parameter sets, and the study's own, by the paper's statements.

    Scrambled Halton points of nine digits, uniform in κ, μ, ln λ and ln v, each judged in every
    reading of the sign of friction (:mod:`squealpipe.reading`), cheap statements first: a set that
    one has refuted is not judged by costlier ones. What a chaotic motion says counts if it says the
    same from five starts 1e-9 l_pre apart, else it is undecided.

    Args:
        params: the study's parameters, whose margins are the baseline's.
        kappa, mu, length_ratio, speed_ratio: ranges of k3/k, μ, L/l_pre, |V|/(l_pre √(k/m)).
        seed: of the scrambling.
        workers: processes; None takes all cores. The result is the same bit for bit.

    Returns:
        Dataset over (sample, reading, statement), see the schema ``parameter_inference``; over
        consequence, the shares of the feasible samples in which further statements hold.

    Raises:
        ValueError: an unknown reading; dashpots or a friction law that the paper does not have.
    """
    refuse_extensions(
        params, "infer_parameters", "the paper's statements are of its own friction"
    )
    reading_of(reading)
    ranges = {
        "kappa": kappa,
        "mu": mu,
        "length_ratio": length_ratio,
        "speed_ratio": speed_ratio,
    }
    groups = _sample(samples, seed, ranges)
    sets = sets_of(groups, tol=tol, workers=workers)
    own = Candidates.of(params, tol=tol)
    by_reading = [_over_samples(sets.read(name)) for name in READINGS]
    joined: dict[str, Any] = {
        name: np.stack([each[name] for each in by_reading]) for name in by_reading[0]
    }
    for name in ("holds", "feasible", "outcome"):
        joined[name] = joined[name].swapaxes(0, 1)
    margins = [list(measure(own.read(name)).values()) for name in READINGS]
    return build(
        parameter_inference_schema,
        {
            **groups,
            **joined,
            **{f"baseline_{name}": getattr(params, name) for name in ranges},
            "baseline_reading": list(READINGS).index(reading),
            "baseline_margin": [
                [float(each.margin[0]) for each in row] for row in margins
            ],
            "criterion": [
                constraint.criterion for constraint in registered_constraints
            ],
        },
        {
            "sample": np.arange(samples),
            "reading": list(READINGS),
            "statement": [constraint.name for constraint in registered_constraints],
            "consequence": list(CONSEQUENCES),
        },
    )


def _over_samples(sets: Candidates) -> dict[str, Any]:
    """Verdicts on all samples in one reading, and their shares."""
    shown = np.arange(sets.size) < FULLY_JUDGED * sets.size
    _, holds = judge(sets, failures=shown.astype(int))
    met, failed = holds == Holds.yes, holds == Holds.no
    feasible = met.all(axis=1)
    alone = failed & (met.sum(axis=1, keepdims=True) == len(registered_constraints) - 1)
    last = [constraint.stage == max(Stage) for constraint in registered_constraints]
    consequences = judge_consequences(sets.subset(np.flatnonzero(feasible)))
    count = int(feasible.sum())
    held = [int(values.sum()) for values in consequences.values()]
    low, high = wilson_interval(count, sets.size)
    return {
        "holds": holds,
        "feasible": feasible,
        "outcome": np.select(
            [feasible, failed.any(axis=1)],
            [Outcome.converged, Outcome.infeasible],
            Outcome.unresolved,
        ),
        "feasible_count": count,
        "share": count / sets.size,
        "share_low": low,
        "share_high": high,
        "share_cut_alone": np.where(
            last, alone.mean(axis=0), alone[shown].mean(axis=0)
        ),
        "feasible_share": np.array(held) / count
        if count
        else np.full(len(held), np.nan),
    }


def _sample(samples: int, seed: int, ranges: dict[str, Range]) -> dict[str, np.ndarray]:
    points = scipy.stats.qmc.Halton(len(ranges), seed=seed).random(samples)
    groups = {}
    for column, (name, limits) in enumerate(ranges.items()):
        share = points[:, column]
        if name in {"length_ratio", "speed_ratio"}:
            groups[name] = np.exp(np.interp(share, (0.0, 1.0), np.log(limits)))
        else:
            groups[name] = np.interp(share, (0.0, 1.0), limits)
        # exp and log differ by a bit from processor to processor, and chaotic runs with them
        groups[name] = np.array([float(f"{value:.9g}") for value in groups[name]])
    return groups
