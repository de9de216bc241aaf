"""What every dataset holds: names, dimensions, units, meanings, tolerances: stated once.

The tables are in the sibling modules, one a topic; a task imports its own table and calls
:func:`build`. :func:`find` gets a schema by name, for readers of files.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cache
from typing import Any

import numpy as np
import xarray as xr


class SchemaError(ValueError):
    """A dataset does not fit its schema; the message names the variable and the mend."""


class Outcome(IntEnum):
    """Why a cell, point or run holds what it holds. No bare NaN: its reason is one of these."""

    converged = 0
    separated = 1
    not_computed = 2
    step_limit = 3
    event_limit = 4
    singular_geometry = 5
    not_finite = 6
    singular_static_state = 7
    complex_pair = 8
    divergence = 9
    rigid_mode = 10
    linear_mode = 11
    isolated_mode = 12
    no_convergence = 13
    wrong_basin = 14
    branch_lost = 15
    pole = 16
    tongue_end = 17
    retraced = 18
    grazing = 19
    beyond_horizon = 20
    infeasible = 21
    unresolved = 22
    free_flight = 23
    amplitude_reached = 24
    unconfirmed = 25


REMEDIES: dict[Outcome, str] = {
    Outcome.converged: "none needed",
    Outcome.separated: "none needed: contact was lost and the question is answered",
    Outcome.not_computed: "the cell was decided without a run; see `computed`",
    Outcome.step_limit: "shorten t_end or raise the step limit",
    Outcome.event_limit: "events accumulate (Zeno-like chatter); shorten t_end",
    Outcome.singular_geometry: "the mass met a pivot (d = 0), where the spring force is undefined",
    Outcome.not_finite: "the state overflowed; check the parameters",
    Outcome.singular_static_state: "no static state: the stiffness matrix is singular there",
    Outcome.complex_pair: "flutter: the pair is complex, omega holds |Im s|",
    Outcome.divergence: "ω² < 0: there is no oscillation at this mode, omega is 0",
    Outcome.rigid_mode: "ω = 0: the springs leave one direction free",
    Outcome.linear_mode: "below contact loss: the orbit is the linear mode",
    Outcome.isolated_mode: "the x mode is decoupled: y is constant and the branch is vertical",
    Outcome.no_convergence: "Newton did not converge; try a smaller step or another start",
    Outcome.wrong_basin: "Newton left the branch; continue from a neighbouring orbit",
    Outcome.branch_lost: "continuation could not go on; reduce its smallest step",
    Outcome.pole: "an internal resonance ω = ω_x/n ends the branch; ask for its other side",
    Outcome.tongue_end: "the branch closes on another one here",
    Outcome.retraced: "the branch turned back onto itself",
    Outcome.grazing: "contact is just touched: derivatives are one-sided",
    Outcome.beyond_horizon: "chaotic beyond the predictability horizon: trust statistics only",
    Outcome.infeasible: "the sample breaks a statement of the paper",
    Outcome.unresolved: "the check could not decide; refine the grid or the horizon",
    Outcome.free_flight: "the mass left the belt and does not come back within t_end",
    Outcome.amplitude_reached: "the asked amplitude was reached",
    Outcome.unconfirmed: "no exact orbit is close to the series; more harmonics or method=exact",
}


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable of a dataset.

    Attributes:
        dims: dimension names, in order.
        units: CF unit; "1" where dimensionless.
        long_name: what it is, for people.
        dtype: NumPy dtype it is stored in.
        flags: value → meaning for flag variables (an IntEnum or a mapping).
        rtol, atol: what counts as "within tolerance" when two datasets are compared.
        nan_allowed: whether NaN may appear; its reason must then be in an outcome variable.
        volatile: differs from run to run by nature (wall times); never part of a verdict.
        optional: may be absent.
    """

    dims: tuple[str, ...] = ()
    units: str = "1"
    long_name: str = ""
    dtype: str = "f8"
    flags: Any = None
    rtol: float = 1e-9
    atol: float = 1e-12
    nan_allowed: bool = False
    volatile: bool = False
    optional: bool = False

    def attributes(self) -> dict[str, Any]:
        """CF attributes of this variable."""
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.flags is not None:
            table = flag_table(self.flags)
            attributes["flag_values"] = np.asarray(list(table), dtype=self.dtype)
            attributes["flag_meanings"] = " ".join(table.values())
        elif np.dtype(self.dtype).kind not in "US":
            attributes["units"] = self.units
        if self.volatile:
            attributes["volatile"] = "true"
        return attributes


@dataclass(frozen=True, kw_only=True)
class DatasetSchema:
    """All variables and coordinates of one kind of dataset."""

    name: str
    title: str
    variables: Mapping[str, Variable]
    coordinates: Mapping[str, Variable] = field(default_factory=dict)
    version: int = 1

    def lookup(self, name: str) -> Variable | None:
        """The entry of a data variable or coordinate."""
        return self.variables.get(name) or self.coordinates.get(name)


def flag_table(flags: Any) -> dict[int, str]:
    """Value → meaning of an IntEnum or a mapping."""
    if isinstance(flags, type) and issubclass(flags, IntEnum):
        return {int(item): item.name for item in flags}
    return {int(value): str(meaning) for value, meaning in flags.items()}


ABSENT = -1
"""Flag of places beyond the end of a run that is shorter than the longest of its sweep."""

OUTCOME = Variable(dtype="i1", flags=Outcome, long_name="why the values are what they are")


def outcome(*dims: str) -> Variable:
    """The outcome variable over some dimensions."""
    return Variable(dims=dims, dtype="i1", flags=Outcome, long_name=OUTCOME.long_name)


def build(
    schema: DatasetSchema,
    data: Mapping[str, Any],
    coords: Mapping[str, Any],
    attrs: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """A labelled dataset from plain arrays.

    Args:
        schema: the table that names dims, units and meanings.
        data: variable → array with the schema's dims.
        coords: coordinate → 1-D array (or an array with the schema's dims).
        attrs: further global attributes.

    Raises:
        SchemaError: something is missing, unknown, of the wrong shape, or NaN without leave.
    """
    variables = {}
    for kind, given, table in (
        ("variable", data, schema.variables),
        ("coordinate", coords, schema.coordinates),
    ):
        unknown = sorted(set(given) - set(table))
        if unknown:
            raise SchemaError(f"{schema.name}: unknown {kind} {', '.join(unknown)}")
        for name, values in given.items():
            entry = table[name]
            array = np.asarray(values)
            dtype = array.dtype if np.dtype(entry.dtype).kind in "US" else entry.dtype
            variables[name] = xr.Variable(entry.dims, array.astype(dtype), entry.attributes())
    dataset = xr.Dataset(
        {name: variables[name] for name in data}, {name: variables[name] for name in coords}
    )
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": schema.title,
        "schema": schema.name,
        "schema_version": schema.version,
        **(attrs or {}),
    }
    validate(dataset, schema)
    return dataset


def validate(dataset: xr.Dataset, schema: DatasetSchema) -> None:
    """Check a dataset against its schema, all faults at once.

    Raises:
        SchemaError: the list of faults.
    """
    faults = []
    if dataset.attrs.get("schema") != schema.name:
        faults.append(f"schema is {dataset.attrs.get('schema')!r}, {schema.name!r} was expected")
    version = dataset.attrs.get("schema_version")
    if version != schema.version:
        faults.append(f"schema version is {version!r}, this package writes {schema.version}")
    for name, entry in {**schema.variables, **schema.coordinates}.items():
        if name not in dataset.variables:
            if not entry.optional:
                faults.append(f"{name} is missing")
            continue
        faults.extend(_variable_faults(name, dataset[name], entry))
    unknown = sorted(
        set(map(str, dataset.variables)) - set(schema.variables) - set(schema.coordinates)
    )
    faults.extend(f"{name} is not part of the schema" for name in unknown)
    if faults:
        raise SchemaError(f"{schema.name}: " + "; ".join(faults))


def _variable_faults(name: str, array: xr.DataArray, entry: Variable) -> list[str]:
    if array.dims != entry.dims:
        return [f"{name} has dims {array.dims}, {entry.dims} expected"]
    expected = np.dtype(entry.dtype)
    if expected.kind in "US":
        return (
            [] if array.dtype.kind in "USO" else [f"{name} has dtype {array.dtype}, text expected"]
        )
    if array.dtype.kind != expected.kind:
        return [f"{name} has dtype {array.dtype}, {expected} expected"]
    if expected.kind == "f" and not entry.nan_allowed and bool(np.isnan(array.values).any()):
        return [f"{name} holds NaN; give the reason in an outcome variable"]
    if entry.flags is not None:
        strangers = np.setdiff1d(array.values, list(flag_table(entry.flags)))
        if strangers.size:
            return [f"{name} holds flags {strangers.tolist()} that have no meaning"]
    return []


def find(name: str) -> DatasetSchema:
    """The schema of that name, from the tables beside this module.

    Raises:
        SchemaError: no table has it.
    """
    schemas = all_schemas()
    if name in schemas:
        return schemas[name]
    if (swept := importlib.import_module(f"{__name__}.sweep").derived(name)) is not None:
        return swept  # type: ignore[no-any-return]
    raise SchemaError(f"no schema {name!r}; known: {', '.join(sorted(schemas))}")


@cache
def all_schemas() -> dict[str, DatasetSchema]:
    """Every schema of the package by name."""
    found = {}
    for module in pkgutil.iter_modules(__path__):
        table = importlib.import_module(f"{__name__}.{module.name}")
        for value in vars(table).values():
            if isinstance(value, DatasetSchema):
                found[value.name] = value
    return found
