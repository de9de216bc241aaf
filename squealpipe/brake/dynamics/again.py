"""Integrate a stored run again, at other instants, or the motion of an answer further."""

import json

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.parameters import Parameters


def simulated_again(run: xr.Dataset, times: np.ndarray) -> xr.Dataset:
    """Integrate a run again by what its attributes state.

    Args:
        run: dataset ``simulation`` as ``simulate`` made it or as it was stored.
        times: (n,) instants at which the state is kept, s; the last one ends the run.

    Raises:
        ValueError: the dataset does not say what it was made by.
    """
    missing = [
        key for key in ("parameters", "arguments", "model") if key not in run.attrs
    ]
    if missing:
        raise ValueError(
            f"the run does not state its {', '.join(missing)}; write it with `squealpipe simulate` "
            "or squealpipe.save"
        )
    return simulate(
        Parameters(**json.loads(run.attrs["parameters"])),
        float(run.alpha1),
        float(run.alpha2),
        t_end=float(times[-1]),
        model=run.attrs["model"],
        tol=float(run.attrs["tolerance"]),
        times=times,
        initial_state=json.loads(run.attrs["arguments"])["initial_state"],
    )


def settled_run(answer: xr.Dataset) -> xr.Dataset:
    """Run on along the settled motion of an answer for 300 periods, long enough to be heard.

    An answer keeps twelve periods, which are too few of a motion that does not repeat. They are
    those of its strongest line; where there is none, of √(mass/k1).

    Args:
        answer: dataset ``assess``.

    Returns:
        Dataset ``simulation`` from where the path of the answer ends; from rest where it has none.
    """
    params = Parameters(**json.loads(answer.attrs["parameters"]))
    time = answer.path_time.values
    place = np.stack([answer.path_x.values, answer.path_y.values], axis=1)
    start = np.zeros(4)
    # an answer repeats its first sample to fill its dimension
    rising = np.diff(time, append=np.inf) > 0.0
    if np.isfinite(place).all() and rising.sum() > 3:
        curve = CubicSpline(time[rising], place[rising])
        start = np.concatenate([place[-1], curve.derivative()(time[-1])])
    frequency = float(answer.frequency)
    period = 1.0 / frequency if np.isfinite(frequency) else params.time_unit
    return simulate(
        params,
        float(answer.alpha1),
        float(answer.alpha2),
        t_end=300.0 * period,
        tol=float(answer.attrs["tolerance"]),
        initial_state=start.tolist(),
    )
