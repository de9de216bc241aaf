"""Intervals between the events of a run, which are exact where samples are not."""

import numpy as np
import xarray as xr

from squealpipe.codes import Event, Regime


def intervals(run: xr.Dataset, regime: Regime) -> np.ndarray:
    """Begin and end of each stay of a ``simulation`` in a regime, s, (stays, 2)."""
    kinds, times = run.event_kind.values, run.event_time.values
    # the next event ends what this one begins
    beginning = {Regime.separated: Event.separation, Regime.stick: Event.stick}[regime]
    begins = [int(run.regime[0]) == regime, *(kinds == beginning)]
    ends = np.append(times, float(run.time_reached))
    return np.stack([np.append(0.0, times), ends], axis=1)[begins]
