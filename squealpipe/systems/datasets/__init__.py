"""Datasets whose names, dimensions, units, meanings and tolerances are stated once, in a schema.

A module ``schema`` holds the tables of what a room makes; :func:`build` makes a dataset by one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from xarray.indexes import PandasIndex

from squealpipe.systems.datasets.agreement import Listing, RoundOff
from squealpipe.systems.datasets.outcomes import Outcome as Outcome
from squealpipe.systems.inputs.gate import checked

SYSTEM = "system "
"""Beginning of the schemas that datasets of systems state: ``system ensemble``."""


class SchemaError(ValueError):
    """A dataset does not fit its schema; the message names the variable and how to fix it."""


@dataclass(frozen=True)
class Variable:
    """One variable of a dataset: what it is, its unit, its dimensions.

    Attributes:
        units: CF unit; "1" where dimensionless.
        dtype: NumPy dtype it is stored in; 8-byte numbers by default.
        flags: value → meaning for flag variables (an IntEnum or a mapping), stored as bytes.
        rtol, atol: what counts as "within tolerance" when two datasets are compared.
        nan_allowed: whether NaN may appear; its reason must then be in an outcome variable.
        volatile: differs from run to run by nature (wall times); never part of a verdict.
        round_off: why round-off decides its digits, and what is compared instead.
    """

    long_name: str = ""
    units: str = "1"
    dims: tuple[str, ...] = ()
    _: KW_ONLY
    dtype: str = ""
    flags: Any = None
    rtol: float = 1e-9
    atol: float = 1e-12
    nan_allowed: bool = False
    volatile: bool = False
    optional: bool = False
    round_off: RoundOff | None = None

    def __post_init__(self) -> None:
        if not self.dtype:
            object.__setattr__(self, "dtype", "f8" if self.flags is None else "i1")

    def attributes(self) -> dict[str, Any]:
        """CF attributes of this variable, a new copy each time."""
        known = self._attributes
        if self.flags is None:
            return known.copy()
        return known | {"flag_values": known["flag_values"].copy()}

    @cached_property
    def stored(self) -> np.dtype:
        """Type that it is stored in."""
        return np.dtype(self.dtype)

    @cached_property
    def meanings(self) -> dict[int, str]:
        """Value → meaning of its flags; empty for other variables."""
        return {} if self.flags is None else flag_table(self.flags)

    @cached_property
    def _attributes(self) -> dict[str, Any]:
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.flags is not None:
            table = self.meanings
            attributes["flag_values"] = np.asarray(list(table), dtype=self.dtype)
            attributes["flag_meanings"] = " ".join(table.values())
            attributes["comment"] = in_words(table)
        elif np.dtype(self.dtype).kind not in "US":
            attributes["units"] = self.units
        if self.volatile:
            attributes["volatile"] = "true"
        return attributes


@dataclass(frozen=True, kw_only=True)
class DatasetSchema:
    """All variables and coordinates of one kind of dataset.

    ``lists`` names the dimensions whose length follows from the result, and how their entries
    are matched when two datasets are compared. ``judged`` names dimensions of which a comparison
    judges some entries alone: those at which a variable has a value.
    """

    name: str
    title: str
    variables: Mapping[str, Variable]
    coordinates: Mapping[str, Variable] = field(default_factory=dict)
    version: int = 1
    lists: Mapping[str, Listing] = field(default_factory=dict)
    judged: Mapping[str, tuple[str, int]] = field(default_factory=dict)

    def lookup(self, name: str) -> Variable | None:
        """The entry of a data variable or coordinate."""
        return self.variables.get(name) or self.coordinates.get(name)


def flag_table(flags: Any) -> dict[int, str]:
    """Value → meaning of an IntEnum or a mapping."""
    if isinstance(flags, type) and issubclass(flags, IntEnum):
        return {int(item): item.name for item in flags}
    return {int(value): str(meaning) for value, meaning in flags.items()}


def in_words(table: Mapping[int, str]) -> str:
    """Flags for people: ``0: converged; 9: divergence (ω² < 0: there is no oscillation …)``."""
    remedies = {
        item.name: item.remedy for item in Outcome if item is not Outcome.converged
    }
    return "; ".join(
        f"{value}: {name.replace('_', ' ')}"
        + (f" ({remedies[name]})" if name in remedies else "")
        for value, name in table.items()
    )


def meanings(variable: xr.DataArray | xr.Variable) -> dict[int, str]:
    """Value → meaning of a flag variable, from its attributes; empty for other variables."""
    names = str(variable.attrs.get("flag_meanings", "")).split()
    values = np.atleast_1d(
        variable.attrs.get("flag_values", [])
    )  # netCDF makes one a number
    return dict(zip(map(int, values), names, strict=True))


OWN_NAMES = "own_names"
"""Attribute of a flag variable: those of its meanings that a user's system gave."""


@checked
def labels(array: xr.DataArray) -> xr.DataArray:
    """A flag variable in words, for people: ``print(labels(dataset.motion))``.

    Names that the user of a system gave stay as they are: ``labels(run.event_kind) == "to_right"``.

    Args:
        array: a variable with ``flag_values`` and ``flag_meanings``.

    Raises:
        ValueError: it has no flags.
    """
    table = meanings(array)
    if not table:
        raise ValueError(
            f"array = {array.name!r}: a variable with flag_meanings is needed"
        )
    own = str(array.attrs.get(OWN_NAMES, "")).split()
    words = {
        value: name if name in own else name.replace("_", " ")
        for value, name in table.items()
    }
    named = np.vectorize(words.get, otypes=[object])(array.values).astype(str)
    return xr.DataArray(named, array.coords, array.dims, array.name)


LICENCE = "MIT"
REFERENCES = (
    "O. T. Şen and R. Singh, Dynamics of a simplified nonlinear model offering insights into the "
    "hammering type brake squeal initiation process, Noise Control Engineering Journal, 2021; "
    "computed by squealpipe (see package_version and commit; CITATION.cff says how to cite it)"
)
ANGLE_CONVENTION = (
    "Spring 1 has its fixed end at (+L1 cos alpha1, +L1 sin alpha1), spring 2 at (-L2 cos alpha2, "
    "+L2 sin alpha2), from the start of the mass; x along the belt (its motion for V > 0), y away "
    "from it; angles in rad"
)
"""Meaning of angles and axes, in every dataset that has angles."""

ABSENT = -1
"""Flag of places beyond the end of a run that is shorter than the longest of its sweep."""

RUN_ENDS = (
    Outcome.converged,
    Outcome.step_limit,
    Outcome.event_limit,
    Outcome.singular_geometry,
    Outcome.not_finite,
    Outcome.accumulation,
    Outcome.hidden_event,
    Outcome.discontinuity,
)
"""Outcomes of a run in time that is to reach its end."""

LINEAR_ENDS = (
    Outcome.converged,
    Outcome.singular_static_state,
    Outcome.complex_pair,
    Outcome.divergence,
    Outcome.rigid_mode,
)
"""Outcomes of a linear model."""

ORBIT_ENDS = (
    *LINEAR_ENDS,
    Outcome.step_limit,
    Outcome.not_finite,
    Outcome.linear_mode,
    Outcome.isolated_mode,
    Outcome.no_convergence,
    Outcome.branch_lost,
    Outcome.pole,
    Outcome.tongue_end,
    Outcome.retraced,
    Outcome.grazing,
    Outcome.unresolved,
    Outcome.amplitude_reached,
    Outcome.unconfirmed,
    Outcome.other_branch,
)
"""Outcomes of periodic motions of model A4 and of their branches."""


def outcome(*dims: str, among: Iterable[Outcome] = Outcome) -> Variable:
    """The outcome variable over some dimensions, with the outcomes that it can have."""
    flags = {int(item): item.name for item in sorted(among)}
    return Variable(
        dims=dims, flags=flags, long_name="why the values are what they are"
    )


def or_nan(
    long_name: str, units: str = "1", dims: tuple[str, ...] = (), **further: Any
) -> Variable:
    """A variable of numbers, or NaN with the reason in an outcome variable."""
    return Variable(long_name, units, dims, nan_allowed=True, **further)


def text(long_name: str, *dims: str, volatile: bool = False) -> Variable:
    """A variable of texts over some dimensions."""
    return Variable(long_name, dims=dims, dtype="U", volatile=volatile)


def flag(long_name: str, flags: Any, *dims: str, **further: Any) -> Variable:
    """A variable of flags over some dimensions: value → meaning, or an IntEnum."""
    return Variable(long_name, dims=dims, flags=flags, **further)


def whether(long_name: str, *dims: str, **further: Any) -> Variable:
    """A variable of truth values over some dimensions."""
    return Variable(long_name, dims=dims, dtype="bool", **further)


def count(long_name: str, *dims: str, dtype: str = "i4", **further: Any) -> Variable:
    """A variable of whole numbers over some dimensions."""
    return Variable(long_name, dims=dims, dtype=dtype, **further)


def build(
    schema: DatasetSchema,
    data: Mapping[str, Any],
    coords: Mapping[str, Any],
    attrs: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """A labelled dataset from plain arrays.

    Args:
        data: variable → array with the schema's dims.
        coords: coordinate → 1-D array (or an array with the schema's dims).
    """
    arrays: dict[str, np.ndarray] = {}
    variables: dict[Any, xr.Variable] = {}
    for kind, given, table in (
        ("variable", data, schema.variables),
        ("coordinate", coords, schema.coordinates),
    ):
        unknown = sorted(given.keys() - table.keys())
        if unknown:
            raise SchemaError(f"{schema.name}: unknown {kind} {', '.join(unknown)}")
        for name, values in given.items():
            entry = table[name]
            try:
                array = np.array(
                    values, None if entry.stored.kind in "US" else entry.stored
                )
                # ``fastpath`` leaves out the search for dates in arrays of numbers
                plain = array.ndim == len(entry.dims) and array.dtype.kind in "fiub"
                variables[name] = xr.Variable(
                    entry.dims, array, entry.attributes(), fastpath=plain
                )
            except (TypeError, ValueError, OverflowError) as error:
                raise SchemaError(f"{schema.name}: {name}: {error}") from error
            arrays[name] = array
    of_coordinates = {name: variables.pop(name) for name in coords}
    # xarray would import pint, in 0.15 s, to make an index of an array
    indexes = {
        name: PandasIndex(pd.Index(arrays[name]), name, arrays[name].dtype)
        for name, variable in of_coordinates.items()
        if variable.dims == (name,)
    }
    for name, index in indexes.items():
        of_coordinates |= index.create_variables({name: of_coordinates[name]})
    dataset = xr.Dataset(variables, xr.Coordinates(of_coordinates, indexes))
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": schema.title,
        "schema": schema.name,
        "schema_version": schema.version,
        "license": LICENCE,
        "references": REFERENCES,
        **({"comment": ANGLE_CONVENTION} if schema.lookup("alpha1") else {}),
        **(attrs or {}),
    }
    _refuse_faults(schema, dataset.attrs, arrays)
    return dataset


def blank(schema: DatasetSchema, **sizes: int) -> dict[str, np.ndarray]:
    """Its variables where there is no result: NaN, 0 or, along dimensions not named, nothing."""
    return {
        name: np.full(
            [sizes.get(dim, 0) for dim in entry.dims],
            np.nan if entry.stored.kind == "f" else 0,
            entry.stored,
        )
        for name, entry in schema.variables.items()
        if not entry.optional
    }


def validate(dataset: xr.Dataset, schema: DatasetSchema) -> None:
    """Check a dataset against its schema, all faults at once."""
    faults = [
        f"{name} has dims {variable.dims}, {entry.dims} expected"
        for name, variable in dataset.variables.items()
        if (entry := schema.lookup(str(name))) is not None
        and variable.dims != entry.dims
    ]
    _refuse_faults(schema, dataset.attrs, {**dataset.variables}, faults)


def _refuse_faults(
    schema: DatasetSchema,
    attrs: Mapping[Any, Any],
    arrays: Mapping[Any, np.ndarray | xr.Variable],
    faults: Iterable[str] = (),
) -> None:
    """Raise for these faults and those of attributes and values, which are read where needed."""
    faults = list(faults)
    if attrs.get("schema") != schema.name:
        faults.append(
            f"schema is {attrs.get('schema')!r}, {schema.name!r} was expected"
        )
    version = attrs.get("schema_version")
    if version != schema.version:
        faults.append(
            f"schema version is {version!r}, this package writes {schema.version}"
        )
    for name, entry in (*schema.variables.items(), *schema.coordinates.items()):
        if name in arrays:
            faults += faults_of_values(name, arrays[name], entry)
        elif not entry.optional:
            faults.append(f"{name} is missing")
    unknown = sorted(
        arrays.keys() - schema.variables.keys() - schema.coordinates.keys()
    )
    faults.extend(f"{name} is not part of the schema" for name in unknown)
    if faults:
        raise SchemaError(f"{schema.name}: " + "; ".join(faults))


def faults_of_values(
    name: str, given: np.ndarray | xr.Variable, entry: Variable
) -> list[str]:
    """Describe the faults of a variable's type, NaN or flags."""
    kind, stored = given.dtype.kind, entry.stored
    if stored.kind in "US":
        return (
            [] if kind in "USO" else [f"{name} has dtype {given.dtype}, text expected"]
        )
    if kind != stored.kind:
        return [f"{name} has dtype {given.dtype}, {stored} expected"]
    if stored.kind == "f" and not entry.nan_allowed:
        values = np.asarray(given)
        if np.isnan(values).any() if values.ndim else math.isnan(values):
            return [f"{name} holds NaN; give the reason in an outcome variable"]
    if entry.flags is not None:
        values = np.asarray(given)
        distinct = np.unique(values).tolist() if values.ndim else [values.item()]
        strangers = set(distinct) - entry.meanings.keys()
        if strangers:
            return [f"{name} holds flags {sorted(strangers)} that have no meaning"]
    return []
