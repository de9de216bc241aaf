"""Datasets of sweeps: the dataset of one task with the swept names as leading dimensions.

Their schema follows from that of the task, so it is derived from its name, for instance
``sweep of stability_map over mu, k3``, instead of being listed.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from squealpipe.parameters import Parameters
from squealpipe.ranges import NUMERIC_PARAMETERS
from squealpipe.schema import (
    ABSENT,
    DatasetSchema,
    SchemaError,
    Variable,
    count,
    find,
    flag_table,
)
from squealpipe.systems.datasets.agreement import RAGGED

OPTIONS = {
    "t_end": Variable("horizon", "s"),
    "tol": Variable("tolerance of the integration", "1"),
    "mode": Variable("mode, by ascending frequency", "1", dtype="i4"),
    "y_peak": Variable("y at the symmetric instant", "m"),
}
"""Options of tasks that can be swept besides parameters and angles."""


def sweep_name(task: str, names: Sequence[str]) -> str:
    """Name of the schema of a sweep."""
    return f"sweep of {task} over {', '.join(names)}"


def swept_coordinate(name: str) -> Variable:
    """Table entry of a swept name."""
    if name in {"alpha1", "alpha2"}:
        return Variable(f"angle of spring {name[-1]}", "rad", (name,))
    if name in OPTIONS:
        return replace(OPTIONS[name], dims=(name,))
    if name in NUMERIC_PARAMETERS:
        return Variable(name, Parameters.units(name), (name,))
    known = ["alpha1", "alpha2", *NUMERIC_PARAMETERS, *OPTIONS]
    raise SchemaError(f"{name!r} cannot be swept; known: {', '.join(known)}")


def derived(name: str) -> DatasetSchema | None:
    """The schema of that name if it is the name of a sweep."""
    match = re.match(r"^sweep of (?P<task>\w+) over (?P<names>\w+(?:, \w+)*)$", name)
    if match is None:
        return None
    names = match["names"].split(", ")
    base = find(match["task"])
    kept = {key: entry for key, entry in base.coordinates.items() if key not in names}
    sizes = {
        f"{dim}_count": count(f"entries that this run has along {dim}", *tuple(names))
        for dim in ragged_dims(base)
    }
    return DatasetSchema(
        name=name,
        title=f"{base.title}, over {', '.join(names)}",
        version=base.version,
        coordinates={
            **{swept: swept_coordinate(swept) for swept in names},
            **{key: entry for key, entry in kept.items() if not is_ragged(entry)},
        },
        variables={
            **{
                key: _with_leading(entry, names)
                for key, entry in {**base.variables, **kept}.items()
                if key not in names and (key in base.variables or is_ragged(entry))
            },
            **sizes,
        },
    )


def ragged_dims(base: DatasetSchema) -> list[str]:
    """Dimensions of a task's dataset that may differ in length from run to run."""
    entries = [*base.variables.values(), *base.coordinates.values()]
    return [dim for dim in RAGGED if any(dim in entry.dims for entry in entries)]


def is_ragged(entry: Variable) -> bool:
    """Return whether a variable has such a dimension."""
    return any(dim in RAGGED for dim in entry.dims)


def _with_leading(entry: Variable, names: Sequence[str]) -> Variable:
    own = tuple(dim for dim in entry.dims if dim not in names)
    swept = replace(entry, dims=(*names, *own))
    if not is_ragged(entry):
        return swept
    if entry.flags is not None:
        return replace(swept, flags={**flag_table(entry.flags), ABSENT: "absent"})
    return replace(swept, nan_allowed=True)


def fill_up(array: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """A shorter run in the shape of the longest: beyond its end is NaN, "" or the flag "absent"."""
    if array.shape == shape:
        return array
    nothing = {"f": np.nan, "U": ""}.get(array.dtype.kind, ABSENT)
    filled = np.full(shape, nothing, dtype=array.dtype)
    filled[tuple(map(slice, array.shape))] = array
    return filled
