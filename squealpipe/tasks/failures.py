"""The failure atlas: all methods on all hard scenes."""

from __future__ import annotations

import xarray as xr

from squealpipe.tasks import failures_frequency, failures_time
from squealpipe.tasks.failure_verdicts import failure_atlas
from squealpipe.tasks.failures_frequency import FREQUENCY_METHODS
from squealpipe.tasks.failures_time import TIME_METHODS


def judge_methods() -> xr.Dataset:
    """Dataset ``failure_atlas``; the scenes set their own parameters, so it takes none."""
    return failure_atlas(
        [*failures_time.scenes(), *failures_frequency.scenes()],
        [*TIME_METHODS, *FREQUENCY_METHODS],
    )
