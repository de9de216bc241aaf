"""Make datasets of systems by their schemas: labels, flags, and the record of the system."""

import json
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.systems.datasets import OWN_NAMES, SYSTEM, Outcome, flag_table, in_words
from squealpipe.systems.datasets.versions import versions
from squealpipe.systems.schema import GRID, check, system_schemas
from squealpipe.systems.taylor import layout
from squealpipe.systems.tracing import TracedSystem as System


class Flags(NamedTuple):
    """Values of a flag variable, the attributes that say what they mean, and further dimensions."""

    values: np.ndarray
    attributes: dict[str, Any]
    dims: tuple[str, ...] = ()


def flag(values: Any, table: Mapping[int, str]) -> Flags:
    """A flag variable with the names of its values."""
    attributes = {
        "flag_values": np.array(list(table), np.int16),
        "flag_meanings": " ".join(name.replace(" ", "_") for name in table.values()),
    }
    return Flags(np.asarray(values, np.int16), attributes)


def named(values: Any, table: Mapping[int, str]) -> Flags:
    """A flag variable whose values, from 0 on, have the names that the system gives them."""
    own = {value: name for value, name in table.items() if value >= 0}
    flags = flag(values, table)
    return flags._replace(attributes=flags.attributes | _own(own))


def _own(table: Mapping[int, str]) -> dict[str, str]:
    """The attribute that holds names of a system's own, if there are any."""
    if not table:
        return {}
    return {OWN_NAMES: " ".join(name.replace(" ", "_") for name in table.values())}


def regime_flag(system: System, regimes: np.ndarray) -> Flags:
    """The flag variable of regimes (…, components); over ``component`` where there are several."""
    names = dict(enumerate(system.regimes))
    if (np.asarray(regimes) < 0).any():
        names[-1] = "not_reached"  # instants after the end of a run
    if len(system.composition.names) == 1:
        return named(np.asarray(regimes)[..., 0], names)
    return named(regimes, names)._replace(dims=("component",))


def outcome(system: System, values: Any) -> Flags:
    """The flag variable that says how runs ended."""
    return explained(system, values, flag_table(Outcome))


def explained(system: System, values: Any, table: Mapping[int, str]) -> Flags:
    """A flag variable of outcomes and of the system's own stops, with what each means and helps."""
    stops = {layout.outcomes.stopped + i: name for i, name in enumerate(system.stops)}
    table = {**table, **stops}
    flags = flag(values, table)
    further = {"comment": in_words(table)} | _own(stops)
    return flags._replace(attributes=flags.attributes | further)


def build(
    system: System,
    what: str,
    values: Mapping[str, Any],
    coordinates: Mapping[str, Any],
    parameters: Mapping[str, float],
    tol: float,
    **attributes: Any,
) -> xr.Dataset:
    """Return a dataset of one of the kinds that :mod:`squealpipe.systems.schema` has tables of.

    Args:
        what: its kind, as "simulate".
        values: name in the table → array, or :class:`Flags`; where the name has brackets, a mapping
            from what they stand for to arrays.
        coordinates: of the table → array, and variables of the starts and parameters that a call
            gives as arrays.
        parameters, tol: those of the runs.
        attributes: further ones.

    Raises:
        SchemaError: a value that its table does not allow.
    """
    table = system_schemas[SYSTEM + what]
    grid = tuple(name for name in coordinates if name not in table.coordinates)
    shape = tuple(len(coordinates[name][1]) for name in grid)
    units = {**system.units, **{n: unit for n, (unit, _) in system.outputs.items()}}
    variables: dict[str, Any] = {name: coordinates[name] for name in grid}
    for name in coordinates.keys() - {*grid}:
        entry = table.coordinates[name]
        variables[name] = (entry.dims, coordinates[name], entry.attributes())
    for pattern, content in values.items():
        entry = table.variables[pattern]
        words = re.findall("<([a-z]+)>", pattern)
        for own, array in content.items() if words else [((), content)]:
            known = dict(zip(words, np.atleast_1d(own).tolist(), strict=True))
            known["unit"] = units.get(known[words[0]], "1") if words else "1"
            flags = array if isinstance(array, Flags) else None
            if flags is None:
                numbers = np.asarray(array, entry.stored)
                label = {"units": _filled(entry.units, known)}
            else:
                numbers, label = flags.values, flags.attributes
            dims = entry.dims if flags is None else (*entry.dims, *flags.dims)
            if entry.dims == (GRID,):
                dims, numbers = grid, numbers.reshape(shape)
            label = {"long_name": _filled(entry.long_name, known), **label}
            variables[_filled(pattern, known)] = dims, numbers, label
    names = system.composition.names
    if "component" in table.coordinates and len(names) > 1:
        variables["component"] = "component", list(names), {"long_name": "component"}
    held = [name for name in (*coordinates, "component") if name in variables]
    dataset = xr.Dataset(
        variables,
        {name: variables.pop(name) for name in held},
        {
            "title": f"{system.name}: {what}",
            "schema": SYSTEM + what,
            "schema_version": table.version,
            "system": json.dumps(system.text),
            "parameters": json.dumps(dict(parameters)),
            "tolerance": tol,
            "method": "Taylor series with located events",
            "package_version": versions()["package_version"],
            **attributes,
        },
    )
    return check(dataset)


def _filled(text: str, known: Mapping[str, str]) -> str:
    """A text with what its words in brackets stand for."""
    return re.sub("<([a-z]+)>", lambda word: known[word[1]], text)
