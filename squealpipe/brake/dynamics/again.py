"""Integrate a stored run again, at other instants."""

import json

import numpy as np
import xarray as xr

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
