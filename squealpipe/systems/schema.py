"""Schemas for datasets of systems, whose variables are named after what each system has.

A name in angle brackets stands for one of the system's own, in the name of a variable and in the
words that describe it: ``late_<name>_min`` is the late minimum of each state and output. The
dimension ``<grid>`` stands for those of the starts and parameters that a call gives as arrays, the
unit ``<unit>`` for that which the system states.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import xarray as xr

from squealpipe.systems.datasets import (
    SYSTEM,
    DatasetSchema,
    SchemaError,
    Variable,
    count,
    faults_of_values,
    meanings,
    or_nan,
    text,
)
from squealpipe.systems.datasets.agreement import ComparedAs, Listing, RoundOff

UNIT, GRID = "<unit>", "<grid>"
CYCLE: dict[str, Any] = {"rtol": 1e-7, "atol": 1e-9}
"""Tolerances within which two ways to a cycle lead to the same one."""
_residual = or_nan(
    "largest residual of the equations, without units", rtol=1.0, atol=1e-8
)
_component_coordinate = {
    "component": replace(text("component", "component"), optional=True)
}


def _flag(long_name: str, *dims: str) -> Variable:
    # type of flags whose meanings are those of a system
    return Variable(long_name, dims=dims, dtype="i2")


def _count(long_name: str, *dims: str) -> Variable:
    return count(long_name, *dims, dtype="i8")


simulate_schema = DatasetSchema(
    name=SYSTEM + "simulate",
    title="One run of a system, with every switch located",
    lists={"event": Listing(kinds=("event_kind",))},
    coordinates={"time": Variable("time", "s", ("time",)), **_component_coordinate},
    variables={
        "regime": _flag("regime, of each component if there are several", "time"),
        "event_time": Variable("time of the event", "s", ("event",)),
        "event_kind": _flag("kind of the event", "event"),
        "event_regime": _flag("regime entered", "event"),
        "end_time": Variable("time reached", "s"),
        "outcome": _flag("how the run ended"),
        "event_time_by_<name>": or_nan(
            "derivative of the event's time by <name>",
            "s / <name>",
            ("event",),
            optional=True,
            rtol=1e-6,
        ),
        "<state>_by_<name>": or_nan(
            "derivative of <state> by <name>",
            f"{UNIT} / <name>",
            ("time",),
            optional=True,
            rtol=1e-6,
        ),
        "<name>": or_nan("<name> along the run", UNIT, ("time",), rtol=1e-7),
    },
)

ensemble_schema = DatasetSchema(
    name=SYSTEM + "ensemble",
    title="Many runs of a system",
    coordinates={
        **_component_coordinate,
        GRID: Variable("start or parameter", UNIT, (GRID,)),
    },
    variables={
        "outcome": _flag("how the run ended", GRID),
        "lyapunov_exponent": or_nan(
            "growth rate of a perturbation", "s-1", (GRID,), optional=True, rtol=1e-5
        ),
        "predictability_horizon": or_nan(
            "time at which an error of tol is lost (NaN: not before the end)",
            "s",
            (GRID,),
            optional=True,
            rtol=1e-5,
        ),
        "count_<event>": _count("number of events <event>", GRID),
        "first_<event>": or_nan("time of the first <event> (NaN: never)", "s", (GRID,)),
        "time_in_<regime>": Variable(
            "time in regime <regime>", "s", (GRID,), rtol=1e-7
        ),
        "late_<name>_min": or_nan(
            "smallest <name> from t_late on (NaN: it was not reached)",
            UNIT,
            (GRID,),
            rtol=1e-7,
        ),
        "late_<name>_max": or_nan(
            "largest <name> from t_late on (NaN: it was not reached)",
            UNIT,
            (GRID,),
            rtol=1e-7,
        ),
        "<name>_min": or_nan("smallest <name>", UNIT, (GRID,), rtol=1e-7),
        "<name>_max": or_nan("largest <name>", UNIT, (GRID,), rtol=1e-7),
        "<state>": or_nan("<state> at the end", UNIT, (GRID,), rtol=1e-7),
    },
)

basin_schema = DatasetSchema(
    name=SYSTEM + "basin",
    title="The kind of motion of a system from each of many starts",
    coordinates=ensemble_schema.coordinates,
    variables={
        "motion": _flag("what the motion has become", GRID),
        "attractor": _count("number of the attractor (-1: unsettled)", GRID),
        "period": or_nan(
            "period of the cycle (NaN: none is known)", "s", (GRID,), **CYCLE
        ),
        "outcome": _flag("how the run ended", GRID),
        "<state>_min": or_nan(
            "smallest <state> in the last quarter", UNIT, (GRID,), **CYCLE
        ),
        "<state>_max": or_nan(
            "largest <state> in the last quarter", UNIT, (GRID,), **CYCLE
        ),
    },
)


def _of_cycles(*dims: str) -> dict[str, Variable]:
    """Return the variables of a cycle that have the same names in every system."""
    multipliers = {
        f"multiplier_{name}": or_nan(
            f"{part} part of the Floquet multipliers, the trivial one first without forcing",
            dims=(*dims, "multiplier"),
            rtol=1e-6,
            atol=1e-6,
        )
        for name, part in (("real", "real"), ("imag", "imaginary"))
    }
    return {
        "period": or_nan("period", "s", dims, **CYCLE),
        "residual": replace(_residual, dims=dims),
        "stable": _flag("whether small disturbances decay", *dims),
        **multipliers,
        "periods": _count("forcing periods, or returns to the section"),
        "start_regime": _flag("regime at t = 0 of the cycle", *dims),
        "outcome": _flag("how the cycle was found", *dims),
    }


def _extremes(*dims: str) -> dict[str, Variable]:
    return {
        "<name>_min": or_nan("smallest <name> over the period", UNIT, dims, **CYCLE),
        "<name>_max": or_nan("largest <name> over the period", UNIT, dims, **CYCLE),
        "<state>_start": or_nan(
            "<state> at t = 0 of the cycle",
            UNIT,
            dims,
            round_off=RoundOff(
                ComparedAs.unjudged,
                "where on a cycle its description starts follows from the way on which it "
                "was found",
            ),
        ),
    }


limit_cycle_schema = DatasetSchema(
    name=SYSTEM + "limit cycle",
    title="A periodic motion of a system, events located, with its Floquet multipliers",
    coordinates=_component_coordinate,
    lists={"event": Listing(kinds=("event_kind",))},
    variables={
        **_of_cycles(),
        "event_time": Variable("time of the event", "s", ("event",), **CYCLE),
        "event_kind": _flag("kind of the event", "event"),
        "event_regime": _flag("regime entered", "event"),
        "time": Variable("time", "s", ("sample",), **CYCLE),
        "event_<state>": Variable("<state> after the event", UNIT, ("event",), **CYCLE),
        "<state>_path": Variable("<state> along the cycle", UNIT, ("sample",), **CYCLE),
        **_extremes(),
    },
)

cycle_branch_schema = DatasetSchema(
    name=SYSTEM + "cycle branch",
    title="A branch of periodic motions of a system in one parameter",
    coordinates=_component_coordinate,
    variables={
        **_of_cycles("point"),
        "label": _flag("what is special about the point", "point"),
        "events": _count("events of the cycle", "point"),
        "end": _flag("why the branch ended"),
        **_extremes("point"),
        "<parameter>": Variable(
            "<parameter> along the branch", UNIT, ("point",), **CYCLE
        ),
    },
)

cycle_curve_schema = DatasetSchema(
    name=SYSTEM + "cycle curve",
    title="A curve of special periodic motions of a system in two parameters",
    variables={
        "period": Variable("period", "s", ("point",), **CYCLE),
        "events": _count("events of the cycle", "point"),
        "residual": replace(_residual, dims=("point",)),
        "label": _flag("what else happens at the point", "point"),
        "outcome": _flag("why the curve ended", "side"),
        "<parameter>": Variable(
            "<parameter> along the curve", UNIT, ("point",), **CYCLE
        ),
    },
)

system_schemas = {
    table.name: table
    for table in (
        simulate_schema,
        ensemble_schema,
        basin_schema,
        limit_cycle_schema,
        cycle_branch_schema,
        cycle_curve_schema,
    )
}


def check(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset itself if each variable is in the table of its kind and as stated there.

    Raises:
        SchemaError: with all faults: a variable that has no place, is missing, or has other
            dimensions or units than its table says; NaN or flags that have no meaning.
    """
    table = system_schemas[dataset.attrs["schema"]]
    coordinates = set(dataset.coords)
    grid = tuple(str(dim) for dim in dataset.coords if dim != "component")
    faults = []
    held = dataset.variables
    for name, variable in held.items():
        entry = entry_of(table.name, str(name))
        if entry is None:
            faults.append(f"{name} is not part of the schema")
            continue
        dims = tuple(dim for dim in variable.dims if dim != "component")
        expected = grid if entry.dims == (GRID,) else entry.dims
        if dims != expected and name not in coordinates:
            faults.append(f"{name} has dims {dims}, {expected} expected")
        unit = variable.attrs.get("units", "1")
        if "<" not in entry.units and entry.units != unit:
            faults.append(f"{name} has units {unit!r}, {entry.units!r} expected")
        described = _described(table.name, str(name), variable)
        faults += faults_of_values(str(name), variable, described)
    for name, entry in table.variables.items():
        if "<" not in name and not entry.optional and name not in held:
            faults.append(f"{name} is missing")
    if faults:
        raise SchemaError(f"{table.name}: " + "; ".join(faults))
    return dataset


def of_dataset(dataset: xr.Dataset) -> DatasetSchema:
    """Return the schema of one dataset: its own names, with the tolerances of the table."""
    name = str(dataset.attrs.get("schema"))
    lists = system_schemas[name].lists if name in system_schemas else {}
    described = {
        str(key): _described(name, str(key), value)
        for key, value in dataset.variables.items()
    }
    of_coordinates = {str(key): described.pop(str(key)) for key in dataset.coords}
    return DatasetSchema(
        name=name,
        title=str(dataset.attrs.get("title")),
        version=int(dataset.attrs.get("schema_version", 1)),
        coordinates=of_coordinates,
        variables=described,
        lists={dim: listing for dim, listing in lists.items() if dim in dataset.dims},
    )


@cache
def entry_of(table: str, name: str) -> Variable | None:
    """Return the first entry of a table that the name of a variable fits; None if none does."""
    if table not in system_schemas:
        return None
    if (exact := system_schemas[table].lookup(name)) is not None:
        return exact
    fits = (entry for pattern, entry in _patterns(table) if pattern.fullmatch(name))
    return next(fits, None)


def names_in_results(own: Mapping[str, Iterable[str]]) -> set[str]:
    """Return the names of dimensions and variables in all results of a system.

    Args:
        own: the word between brackets → the system's names that it stands for.
    """
    names: set[str] = set()
    for table in system_schemas.values():
        for name, entry in {**table.variables, **table.coordinates}.items():
            names.update(entry.dims)
            before, bracket, rest = name.partition("<")
            word, _, after = rest.partition(">")
            if not bracket:
                names.add(name)
            elif before or after:  # else it is one of the system's own
                names.update(f"{before}{each}{after}" for each in own.get(word, ()))
    return names


@cache
def _patterns(table: str) -> list[tuple[re.Pattern[str], Variable]]:
    entries = {**system_schemas[table].variables, **system_schemas[table].coordinates}
    return [
        (re.compile(re.sub("<[a-z]+>", ".+", name)), entry)
        for name, entry in entries.items()
        if "<" in name
    ]


def _described(table: str, name: str, variable: xr.Variable) -> Variable:
    """Return an entry with a variable's own name and units and its table's tolerances."""
    texts = variable.dtype.kind in "UO"
    entry = entry_of(table, name) or Variable(nan_allowed=True)
    return Variable(
        str(variable.attrs.get("long_name", name)),
        str(variable.attrs.get("units", "1")),
        tuple(map(str, variable.dims)),
        dtype="U" if texts else variable.dtype.str[1:],
        flags=meanings(variable) if "flag_values" in variable.attrs else None,
        nan_allowed=entry.nan_allowed or variable.dtype.kind != "f",
        rtol=entry.rtol,
        atol=entry.atol,
        round_off=entry.round_off,
    )
