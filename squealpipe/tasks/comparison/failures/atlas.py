"""The failure atlas: all methods on all hard scenes."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from squealpipe.tasks.comparison.failures import frequency as failures_frequency
from squealpipe.tasks.comparison.failures import time as failures_time
from squealpipe.tasks.comparison.failures.frequency import FREQUENCY_METHODS
from squealpipe.tasks.comparison.failures.time import TOLERANCES, time_methods
from squealpipe.tasks.comparison.failures.verdicts import failure_atlas


def judge_methods(
    *,
    solvers: Sequence[str] = ("DOP853", "RK45", "LSODA", "Radau"),
    tolerances: Sequence[float] = TOLERANCES,
    chaotic_horizon: float = 200.0,
    beyond_horizon: float = 600.0,
) -> xr.Dataset:
    """Dataset ``failure_atlas``; the scenes set their own parameters.

    Args:
        solvers: methods of ``solve_ivp`` to put on trial with events.
        tolerances: given to every method in time alike.
        chaotic_horizon: end of the chaotic run, √(m/k1), before our predictability horizon.
        beyond_horizon: end of the run that goes beyond it (it is at 286).
    """
    return failure_atlas(
        [
            *failures_time.scenes(solvers, tolerances, chaotic_horizon, beyond_horizon),
            *failures_frequency.scenes(),
        ],
        [*time_methods(solvers, tolerances), *FREQUENCY_METHODS],
    )
