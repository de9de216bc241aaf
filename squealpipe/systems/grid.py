"""Arguments of a call: single values, or an outer product of starts and parameters."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.systems.definition import in_unit_of_state
from squealpipe.systems.inputs.gate import real_array
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.tracing import TracedSystem as System


@dataclass(frozen=True)
class Grid:
    """An outer product of starts and parameters.

    Attributes:
        shape: of the product.
        values: each state and parameter in every run, (runs,).
        coordinates: those that vary, as the dimensions of a dataset.
        fixed: the others.
        regime: in which all start, if it is given.
    """

    shape: tuple[int, ...]
    values: dict[str, np.ndarray]
    coordinates: dict[str, Any]
    fixed: dict[str, float]
    regime: str | None


def outer_product(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> Grid:
    """The grid of what a call gives as 1-D arrays, starts first."""
    given = {
        n: real_array(n, v) for n, v in call_values(system, start, parameters).items()
    }
    for name, value in given.items():
        if value.ndim > 1:
            raise ValueError(
                f"{name} has shape {value.shape}: a number or a 1-D array is needed"
            )
    order = [name for name in start or {} if name != "regime"]
    swept = [name for name in (*order, *parameters) if given[name].ndim]
    shape = tuple(given[name].size for name in swept)
    axes = np.meshgrid(*(given[name] for name in swept), indexing="ij")
    fixed = {name: float(value) for name, value in given.items() if not value.ndim}
    size = math.prod(shape)
    values = {name: np.full(size, value) for name, value in fixed.items()}
    values |= {name: axis.ravel() for name, axis in zip(swept, axes, strict=True)}
    coordinates = {}
    for name in swept:
        at_start = name in system.units
        label = {
            "long_name": f"{name} at the start" if at_start else f"parameter {name}",
            "units": system.units.get(name, "1"),
        }
        dim = system.start_names[name] if at_start else name
        coordinates[dim] = (dim, given[name], label)
    return Grid(shape, values, coordinates, fixed, (start or {}).get("regime"))


def duration_of(t_start: float, t_end: float) -> float:
    """Return how long runs take; refuse an end before the start."""
    if t_end < t_start:
        raise ValueError(f"t_end = {t_end!r}: a time not before {t_start:g} is needed")
    return t_end - t_start


def scalar(name: str, value: Any) -> float:
    """One finite number."""
    array = real_array(name, value)
    if array.ndim:
        raise ValueError(f"{name} has shape {array.shape}: one number is needed")
    return float(array)


def call_values(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> dict[str, Any]:
    """States and parameters of a call, the system's where it gives none."""
    start = dict(start or {})
    system.check_regime(start)
    start.pop("regime", None)
    for name in start:
        if name not in system.units:
            raise ValueError(
                f"start: {name!r} is unknown; {suggestion(str(name), system.units)}"
            )
    for name in parameters:
        system.check_parameter(name)
    states = {name: system.start[name] for name in system.units}
    start = {name: in_unit_of_state(system.units, name, start[name]) for name in start}
    return {**states, **system.parameters, **start, **parameters}
