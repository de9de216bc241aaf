"""Looking things up in the A1 motions of the paper's scenes."""

import numpy as np
import scipy
import xarray as xr

from squealpipe.brake.schema.dynamics.extremes import extremes, largest_size
from squealpipe.codes import Event
from squealpipe.paper.schema.growth import GROWTH_HORIZON, GrowthRule
from squealpipe.study.evidence import Evidence, MissingDataError


def scene(run: Evidence, name: str) -> xr.Dataset:
    """The A1 motion of a scene of the paper."""
    return run[f"simulate/{name}"]


def events(motion: xr.Dataset, kind: Event) -> np.ndarray:
    """Times of the events of a kind, in the run's unit of time."""
    return np.asarray(motion.event_time.values[motion.event_kind.values == kind])


def until(run: Evidence, motion: xr.Dataset) -> str:
    """Return the end of a run for sentences: ``t = 50 √(m/k1)``."""
    return f"t = {float(motion.time[-1]) / run.parameters.time_unit:g} √(m/k1)"


def halves(motion: xr.Dataset) -> tuple[float, float]:
    """Largest |x| in the first and in the second half of a run, in units of l_pre."""
    if motion.sizes["time"] < 10:
        raise MissingDataError("the run holds fewer than ten instants")
    half = motion.sizes["time"] // 2
    size = largest_size(motion, "x") / float(motion.preload)
    return float(size[:half].max()), float(size[half:].max())


def windows(run: Evidence, motion: xr.Dataset) -> np.ndarray:
    """Largest |x| in each window of a long run, in units of l_pre."""
    end = float(motion.time[-1]) / run.parameters.time_unit
    if end < GROWTH_HORIZON * (1.0 - 1e-9):
        raise MissingDataError(
            f"the long run ends at {end:g} √(m/k1), before {GROWTH_HORIZON:g}"
        )
    size = largest_size(motion, "x") / float(motion.preload)
    window = (
        motion.time.values / (GrowthRule.window * run.parameters.time_unit)
    ).astype(int)
    return np.array(
        [size[window == number].max() for number in range(GrowthRule.n_windows)]
    )


def repetition(motion: xr.Dataset) -> tuple[float, int, int]:
    """Return how nearly a motion repeats, from its states at the returns to the belt.

    Returns:
        The largest change of x or a velocity from one return to another, as a share of its range
        in the run, over the second half of the returns, for the number of returns apart for which
        it is least; that number; and the number of all returns.
    """
    instants = events(motion, Event.contact)
    # fewer than eight returns to the belt tell nothing about repetition
    if instants.size < 8:
        raise MissingDataError(f"the run has {instants.size} returns to the belt")
    time = motion.time.values
    tracks = [
        scipy.interpolate.CubicHermiteSpline(
            time, motion[name].values, motion[f"v{name}"].values
        )
        for name in "xy"
    ]
    states = np.stack(
        [tracks[0](instants), *(track(instants, 1) for track in tracks)], axis=1
    )
    ranges = [np.ptp(extremes(motion, name)) for name in ("x", "vx", "vy")]
    late = states[states.shape[0] // 2 :] / np.array(ranges)
    changes = [
        np.abs(late[apart:] - late[:-apart]).max()
        for apart in range(1, late.shape[0] // 2 + 1)
    ]
    best = int(np.argmin(changes))
    return float(changes[best]), best + 1, int(instants.size)


def frequency(motion: xr.Dataset) -> float:
    """Mean angular frequency of the contact force, from its crossings of the mean, upwards."""
    force = motion.normalized_contact_force.values
    above = force > force.mean()
    rising = np.flatnonzero(~above[:-1] & above[1:])
    if rising.size < 2:
        raise MissingDataError("the contact force completes no oscillation")
    share_of_step = (force.mean() - force[rising]) / (force[rising + 1] - force[rising])
    instants = (
        motion.time.values[rising] + share_of_step * np.diff(motion.time.values)[rising]
    )
    return float(2 * np.pi * (rising.size - 1) / (instants[-1] - instants[0]))
