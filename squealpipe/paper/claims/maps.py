"""Looking things up in maps over both spring angles."""

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.study.evidence import Evidence, MissingDataError

AT_SCENES = "at_scenes/"
"""Folder of the linear maps at the angles of the paper's scenes alone."""

SAME_STIFFNESS = 1e-12
"""Share of a stiffness below which a difference of stiffnesses counts as none."""


def cell(
    run: Evidence, name: str, alpha1_over_pi: float, alpha2_over_pi: float
) -> xr.Dataset:
    """A linear map's cell at a pair of angles: of the map at the paper's angles, on no grid."""
    where = f"cell ({alpha1_over_pi:g}π, {alpha2_over_pi:g}π)"
    angles = alpha1_over_pi * np.pi, alpha2_over_pi * np.pi
    return _nearest(run[f"{AT_SCENES}{name}"], *angles, where)


def on_grid_of(dataset: xr.Dataset, other: xr.Dataset) -> xr.Dataset:
    """The cells of a map that are also cells of another one."""
    on_grid = _nearest(
        dataset, other.alpha1, other.alpha2, f"cells of {other.attrs['schema']}"
    )
    # angles that differ by round-off would be dropped where both maps are compared
    return on_grid.assign_coords(alpha1=other.alpha1, alpha2=other.alpha2)


def _nearest(dataset: xr.Dataset, alpha1: Any, alpha2: Any, what: str) -> xr.Dataset:
    try:
        return dataset.sel(
            alpha1=alpha1, alpha2=alpha2, method="nearest", tolerance=1e-6 * np.pi
        )
    except KeyError as error:
        raise MissingDataError(
            f"the grid of {dataset.attrs['schema']} has no {what}"
        ) from error


def angle_sum_over_pi(dataset: xr.Dataset | xr.DataArray) -> xr.DataArray:
    """(α1 + α2)/π over a map."""
    total: xr.DataArray = (dataset.alpha1 + dataset.alpha2) / np.pi
    return total


def is_multiple(
    values: xr.DataArray, of: float = 1.0, *, odd: bool = False
) -> xr.DataArray:
    """Return where values are a whole (or odd) multiple, to a millionth."""
    ratio = values / of
    whole: xr.DataArray = abs(ratio - ratio.round()) < 1e-6
    return whole & (ratio.round() % 2 == 1) if odd else whole


def share(condition: xr.DataArray) -> float:
    """Share of cells in which a condition is true."""
    return float(condition.mean())


def place(dataset: xr.Dataset, values: xr.DataArray) -> tuple[float, float]:
    """(α1/π, α2/π) where values are largest."""
    row, column = np.unravel_index(int(values.values.argmax()), values.shape)
    return float(dataset.alpha1[row] / np.pi), float(dataset.alpha2[column] / np.pi)


def unstable_cells(run: Evidence) -> xr.DataArray:
    """Cells of the stability map in which A3 is unstable."""
    cells: xr.DataArray = run["stability_map"].regime_linear > 0
    return cells


def unstable_yet_sliding(run: Evidence) -> tuple[xr.DataArray, xr.DataArray]:
    """Unstable cells where sliding is possible: by Eq. (11) as printed, and by R_n > 0."""
    unstable, sliding = unstable_cells(run), run["quasi_static_map"]
    return unstable & (sliding.possible_as_printed == 1), unstable & (
        sliding.possible == 1
    )


def coupling_is_negative(run: Evidence) -> xr.DataArray:
    """Cells with K12 < 0."""
    largest = run.parameters.k1 + run.parameters.k2
    return stiffness(run, "stiffness_xy") < -SAME_STIFFNESS * largest


def order_turns_over(run: Evidence, sliding: xr.Dataset) -> xr.DataArray:
    """Cells in which x is the softer direction in contact and y when separated.

    In contact x is the softer direction while K11 < K22 + k3, separated while K11 < K22.
    """
    difference = sliding.stiffness_x - sliding.stiffness_y
    k3 = run.parameters.k3
    turned: xr.DataArray = (difference > SAME_STIFFNESS * k3) & (
        difference < (1 - SAME_STIFFNESS) * k3
    )
    return turned


def stiffness(run: Evidence, name: str) -> xr.DataArray:
    """K11 (``stiffness_x``), K12 (``stiffness_xy``) or K22 (``stiffness_y``) over the map, N/m."""
    return run["quasi_static_map"][name]
