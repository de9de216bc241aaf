"""Big maps and sweeps in parts, each a dataset of its own, for many machines.

A cell of a map does not know its neighbours, nor does a run of a sweep, so what is joined equals
what is made at once bit for bit.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.ranges import longest
from squealpipe.study.job import Job
from squealpipe.study.schema.sweep import fill_up
from squealpipe.systems.datasets.agreement import RAGGED


def scattered_rows(rows: int, item: str) -> slice:
    """Rows of one part, "i-of-n", of a scattered map."""
    index, count = map(int, item.split("-of-"))
    if count > rows:
        raise ValueError(
            f"{count} parts of {rows} rows: scatter into at most {rows} parts"
        )
    return slice(rows * (index - 1) // count, rows * index // count)


def scattered_values(
    vary: Mapping[str, Sequence[float]], item: str
) -> dict[str, Sequence[float]]:
    """Return the values that one part of a scattered sweep varies: all names, and a share of the
    values of the longest one.
    """
    cut = longest(vary)
    return {**vary, cut: vary[cut][scattered_rows(len(vary[cut]), item)]}


def over_angles(job: Job, name: str) -> dict[str, Any]:
    """Angles from 0 to π, horizon and tolerance of a map; of a scattered one a part's rows.

    Args:
        name: of the map, whose keys are ``dynamics.<name>_points`` and ``…_horizon``.
    """
    angles = np.linspace(0.0, np.pi, job.settings[f"dynamics.{name}_points"])
    return {
        "alpha1": angles[scattered_rows(angles.size, job.item)],
        "alpha2": angles,
        "t_end": job.settings[f"dynamics.{name}_horizon"] * job.params.time_unit,
        "tol": job.settings["dynamics.tol"],
    }


def join(parts: Sequence[xr.Dataset], along: str = "alpha1") -> xr.Dataset:
    """One map or sweep from its parts, in order; they differ in ``along`` alone.

    Runs of a sweep that are shorter than the longest of all parts are filled up.
    """
    if not parts:
        raise ValueError("no parts to join")
    sizes = {
        dim: max(part.sizes[dim] for part in parts)
        for dim in RAGGED
        if dim != along and all(dim in part.dims for part in parts)
    }
    try:
        return xr.concat(
            [_filled(part, sizes) for part in parts],
            along,
            data_vars="minimal",
            coords="minimal",
            compat="override",
            join="exact",
            combine_attrs="override",
        )
    except ValueError as error:
        raise ValueError(
            f"the parts are not blocks of rows of one map, cut along {along}: {error}"
        ) from error


def _filled(part: xr.Dataset, sizes: Mapping[str, int]) -> xr.Dataset:
    """A part whose runs are as long as the longest of all."""
    variables = {}
    for name, variable in part.variables.items():
        shape = tuple(sizes.get(str(dim), size) for dim, size in variable.sizes.items())
        variables[name] = (
            variable.dims,
            fill_up(variable.values, shape),
            variable.attrs,
        )
    return xr.Dataset(variables, attrs=part.attrs).set_coords([*part.coords])
