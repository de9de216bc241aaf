"""Which parameters agree with the paper's statements: quasi-random samples, margins, the baseline.

The paper prints no numbers. Equal springs are assumed (Fig. 5 and the isolated x mode of Fig. 12
need them); κ, μ, λ, v and the direction of the belt are left.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import xarray as xr
from pydantic import Strict
from scipy.stats import qmc

from squealpipe.models.refusals import refuse_extensions
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.inference import PARAMETER_INFERENCE, wilson_interval
from squealpipe.schema.origin import recorded
from squealpipe.tasks.inference.consequences import CONSEQUENCES, judge_consequences
from squealpipe.tasks.inference.constraints import CONSTRAINTS, Candidates, candidate_of, measure
from squealpipe.validation import Natural, Number, Seed, Tolerance, Workers

Range = Annotated[tuple[Number, Number], Strict(strict=False)]  # a list of a configuration too


@recorded(model="A1", method="Taylor series with located events over quasi-random samples")
def infer_parameters(
    params: Parameters,
    *,
    samples: Natural,
    kappa: Range = (0.3, 1.3),
    mu: Range = (0.02, 0.8),
    length_ratio: Range = (2.0, 100.0),
    speed_ratio: Range = (0.1, 316.0),
    seed: Seed = 2021,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Judge quasi-random parameter sets, and the study's own, by the paper's statements.

    Scrambled Halton points, uniform in κ, μ, ln λ, ln v and in the direction of the belt.

    Args:
        params: the study's parameters, whose margins are the baseline's.
        samples: number of parameter sets.
        kappa, mu, length_ratio, speed_ratio: ranges of k3/k, μ, L/l_pre, |V|/(l_pre √(k/m)).
        seed: of the scrambling.
        tol: tolerance of the integrator.
        workers: processes; None takes all cores. The result is the same bit for bit.

    Returns:
        Dataset over (sample, statement), see the schema ``parameter_inference``; and over
        consequence, the shares of the feasible samples in which further statements hold.

    Raises:
        ValueError: dashpots or a friction law that the paper does not have.
    """
    refuse_extensions(params, "infer_parameters", "the paper's statements are of its own friction")
    groups = _sample(samples, seed, kappa, mu, length_ratio, speed_ratio)
    ones = np.ones(samples)
    candidates = Candidates(
        {
            "mass": ones,
            "k1": ones,
            "k2": ones,
            "k3": groups["kappa"],
            "mu": groups["mu"],
            "preload": ones,
            "length1": groups["length_ratio"],
            "length2": groups["length_ratio"],
            "belt_speed": groups["direction"] * groups["speed_ratio"],
        },
        tol,
        workers,
    )
    margins = measure(candidates)
    margin = np.stack([found.margin for found in margins.values()], axis=1)
    ended = np.stack([found.outcome for found in margins.values()], axis=1)
    decided = (ended == Outcome.converged) & np.isfinite(margin)
    holds = decided & (margin > 0)
    feasible = holds.all(axis=1)
    alone = (~holds).sum(axis=1, keepdims=True) == 1
    refuted = (decided & (margin <= 0)).any(axis=1)
    inferred = {name: values[feasible] for name, values in candidates.fields.items()}
    consequences = judge_consequences(inferred, tol=tol, workers=workers)
    study = candidate_of(params, tol=tol)
    own = measure(study)
    own_consequences = judge_consequences(study.fields, tol=tol, workers=workers)
    own_margin = np.array([float(own[constraint.name].margin[0]) for constraint in CONSTRAINTS])
    own_outcome = np.array([int(own[constraint.name].outcome[0]) for constraint in CONSTRAINTS])
    return build(
        PARAMETER_INFERENCE,
        {
            **groups,
            "margin": np.where(np.isfinite(margin), margin, -1.0),
            "holds": holds,
            "feasible": feasible,
            "outcome": np.select(
                [feasible, refuted], [Outcome.converged, Outcome.infeasible], Outcome.unresolved
            ),
            "baseline_kappa": params.kappa,
            "baseline_mu": params.mu,
            "baseline_length_ratio": params.length_ratio,
            "baseline_speed_ratio": params.speed_ratio,
            "baseline_margin": own_margin,
            "baseline_holds": (own_margin > 0) & (own_outcome == Outcome.converged),
            "baseline_outcome": own_outcome,
            "criterion": [constraint.criterion for constraint in CONSTRAINTS],
            "horizon": [constraint.horizon for constraint in CONSTRAINTS],
            "share_holding": holds.mean(axis=0),
            "share_cut_alone": (~holds & alone).mean(axis=0),
            "consequence_check": list(CONSEQUENCES.values()),
            "feasible_count": int(feasible.sum()),
            "feasible_share": [
                held.mean() if held.size else np.nan for held in consequences.values()
            ],
            **_intervals(consequences),
            "baseline_consequence": [bool(held[0]) for held in own_consequences.values()],
        },
        {
            "sample": np.arange(samples),
            "statement": [constraint.name for constraint in CONSTRAINTS],
            "consequence": list(CONSEQUENCES),
        },
    )


def _intervals(consequences: Mapping[str, np.ndarray]) -> dict[str, list[float]]:
    """Sampling error of each share: Wilson's interval."""
    limits = [wilson_interval(int(held.sum()), held.size) for held in consequences.values()]
    return {
        "feasible_share_low": [low for low, _ in limits],
        "feasible_share_high": [high for _, high in limits],
    }


def _sample(
    samples: int, seed: int, kappa: Range, mu: Range, length_ratio: Range, speed_ratio: Range
) -> Mapping[str, Any]:
    points = qmc.Halton(5, seed=seed).random(samples)

    def spread(column: int, limits: Range) -> np.ndarray:
        return np.asarray(np.interp(points[:, column], (0.0, 1.0), limits))

    def spread_log(column: int, limits: Range) -> np.ndarray:
        return np.asarray(np.exp(spread(column, (np.log(limits[0]), np.log(limits[1])))))

    return {
        "kappa": spread(0, kappa),
        "mu": spread(1, mu),
        "length_ratio": spread_log(2, length_ratio),
        "speed_ratio": spread_log(3, speed_ratio),
        "direction": np.where(points[:, 4] < 0.5, 1, -1),
    }
