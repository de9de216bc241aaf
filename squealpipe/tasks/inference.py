"""Which parameters agree with the paper's statements: quasi-random samples, margins, the baseline.

The paper prints no numbers. Equal springs are assumed (Fig. 5 and the isolated x mode of Fig. 12
need them); κ, μ, λ, v and the direction of the belt are left.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import qmc

from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.inference import PARAMETER_INFERENCE
from squealpipe.tasks.consequences import CONSEQUENCES, judge_consequences
from squealpipe.tasks.statements import STATEMENTS, Candidates, candidate_of, measure

Range = tuple[float, float]


def infer_parameters(
    params: Parameters,
    *,
    samples: int,
    kappa: Range = (0.3, 1.3),
    mu: Range = (0.02, 0.8),
    length_ratio: Range = (2.0, 100.0),
    speed_ratio: Range = (0.1, 316.0),
    seed: int = 2021,
    tol: float = 1e-9,
    workers: int | None = None,
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
    """
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
    verdicts = measure(candidates)
    margin = np.stack([verdict.margin for verdict in verdicts.values()], axis=1)
    ended = np.stack([verdict.outcome for verdict in verdicts.values()], axis=1)
    decided = (ended == Outcome.converged) & np.isfinite(margin)
    holds = decided & (margin > 0)
    feasible = holds.all(axis=1)
    alone = (~holds).sum(axis=1, keepdims=True) == 1
    refuted = (decided & (margin <= 0)).any(axis=1)
    inferred = {name: values[feasible] for name, values in candidates.fields.items()}
    consequences = judge_consequences(inferred, tol=tol, workers=workers)
    own = measure(candidate_of(params, tol=tol))
    own_margin = np.array([float(own[statement.name].margin[0]) for statement in STATEMENTS])
    own_outcome = np.array([int(own[statement.name].outcome[0]) for statement in STATEMENTS])
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
            "criterion": [statement.criterion for statement in STATEMENTS],
            "horizon": [statement.horizon for statement in STATEMENTS],
            "share_holding": holds.mean(axis=0),
            "share_cut_alone": (~holds & alone).mean(axis=0),
            "consequence_check": list(CONSEQUENCES.values()),
            "feasible_count": int(feasible.sum()),
            "feasible_share": [
                held.mean() if held.size else np.nan for held in consequences.values()
            ],
        },
        {
            "sample": np.arange(samples),
            "statement": [statement.name for statement in STATEMENTS],
            "consequence": list(CONSEQUENCES),
        },
    )


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
