"""The gate for arrays that users give: real, finite numbers, or an error that names the culprit."""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np

from squealpipe.parameters import brief

KINDS = {
    "U": "text",
    "S": "bytes",
    "b": "truth values",
    "c": "complex numbers",
    "M": "dates",
    "m": "durations",
}
"""What else than numbers people give, by NumPy's letter."""


def real_array(name: str, values: Any, *, infinite: bool = False) -> np.ndarray:
    """A float array.

    Raises:
        ValueError: no real numbers, masked entries, NaN or (unless allowed) infinity, with the
            name and the first culprit.
    """
    # most often, and most runs
    if isinstance(values, float) and abs(values) <= (math.inf if infinite else sys.float_info.max):
        return np.array(values)
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked entries: fill them or leave them out")
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{name} = {brief(values)}: rows of one length are needed") from error
    if array.dtype.kind not in "fiu":
        kind = KINDS.get(array.dtype.kind, "objects")
        raise ValueError(f"{name} = {brief(values)}: numbers are needed, not {kind}")
    array = array.astype(float)
    bad = np.isnan(array) if infinite else ~np.isfinite(array)
    if bad.any():
        raise ValueError(f"{name} holds {float(array[bad].flat[0])!r}: finite numbers are needed")
    return array


def real_number(
    name: str, value: Any, *, above: float = -math.inf, least: float = -math.inf
) -> float:
    """A finite number, also of an array without dimensions.

    Raises:
        ValueError: no such number, not greater than ``above``, or less than ``least``.
    """
    array = real_array(name, value)
    if array.ndim:
        raise ValueError(f"{name} = {brief(value)}: one number is needed")
    if not array > above:
        raise ValueError(f"{name} = {brief(value)}: must be greater than {above:g}")
    if not array >= least:
        raise ValueError(f"{name} = {brief(value)}: must be {least:g} or greater")
    return float(array)


def angle_axis(name: str, values: Any) -> np.ndarray:
    """A 1-D array of angles, rad; one number is an array of one.

    Raises:
        ValueError: it has more dimensions, is empty, or holds no finite numbers.
    """
    angles = np.atleast_1d(real_array(name, values))
    if angles.ndim != 1 or not angles.size:
        raise ValueError(
            f"{name} has shape {angles.shape}: a 1-D array of finite angles in rad is needed"
        )
    return angles
