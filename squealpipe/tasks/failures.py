"""The failure atlas: all methods on all hard scenes."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from squealpipe.tasks import failures_frequency, failures_time
from squealpipe.tasks.failure_verdicts import failure_atlas
from squealpipe.tasks.failures_frequency import FREQUENCY_METHODS
from squealpipe.tasks.failures_time import time_methods


def judge_methods(
    *,
    solvers: Sequence[str] = ("DOP853", "RK45", "LSODA", "Radau"),
    chaotic_horizon: float = 200.0,
    beyond_horizon: float = 600.0,
) -> xr.Dataset:
    """Dataset ``failure_atlas``; the scenes set their own parameters.

    Args:
        solvers: methods of ``solve_ivp`` to put on trial with events.
        chaotic_horizon: end of the chaotic run, √(m/k1), before our predictability horizon.
        beyond_horizon: end of the run that goes beyond it (it is at 286).
    """
    return failure_atlas(
        [
            *failures_time.scenes(solvers, chaotic_horizon, beyond_horizon),
            *failures_frequency.scenes(),
        ],
        [*time_methods(solvers), *FREQUENCY_METHODS],
    )
