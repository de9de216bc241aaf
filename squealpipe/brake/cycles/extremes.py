"""Ends of runs from many starts: the brute-force counterpart of a branch."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.schema.cycles import settled_extremes_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.validation import (
    Natural,
    NotNegativeVector,
    Positive,
    Seed,
    Tolerance,
    Workers,
)


@recorded(model="A1", method="Taylor series with located events")
def settled_extremes(
    params: Parameters,
    scenes: Mapping[str, tuple[float, float]],
    mu: NotNegativeVector,
    *,
    starts: Natural,
    t_end: Positive,
    seed: Seed = 1,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Largest |x| in the last fifth of runs from starts near and far.

    The first start of each cell is r = 0 at rest; the others are at rest at random places whose
    distance is evenly spread on a logarithmic scale.

    Args:
        scenes: name → angles, rad.
        seed: of the random starts, which all scenes and frictions share.
    """
    generator = np.random.default_rng(seed)
    # smallest and largest distance of a start from r = 0, over l_pre
    amplitudes = (0.01, 30.0)
    low, high = np.log(amplitudes)
    distance = params.preload * np.exp(generator.uniform(low, high, starts))
    direction = generator.uniform(0.0, 2.0 * np.pi, starts)
    distance[0] = 0.0
    state = np.zeros((starts, 4))
    state[:, 0] = distance * np.cos(direction)
    state[:, 1] = distance * np.sin(direction)
    angles = np.array(list(scenes.values()))
    run = run_ensemble(
        {**params.as_dict(), "mu": mu[None, :, None]},
        angles[:, 0][:, None, None],
        angles[:, 1][:, None, None],
        t_end=t_end,
        t_late=0.8 * t_end,
        tracked=("x",),
        tol=tol,
        initial_state=np.broadcast_to(state, (len(scenes), len(mu), starts, 4)),
        workers=workers,
    )
    return build(
        settled_extremes_schema,
        {"late_max_x": run.late_max_x, "outcome": run.outcome, "t_end": t_end},
        {"scene": list(scenes), "mu": mu, "start": np.arange(starts)},
    )
