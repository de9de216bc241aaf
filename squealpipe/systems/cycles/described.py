"""Cycles as the variables of datasets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.solution import Cycle, CycleAccuracy
from squealpipe.systems.datasets import Outcome, flag_table
from squealpipe.systems.labels import (
    attributes_of,
    components_of,
    explained,
    flag,
    labels,
    named,
    regime_flag,
)

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System

SETTLED_ON = 200
"""Outcome of a settled motion of k periods, less k."""


def columns(cycle: Cycle | None, system: System) -> dict[str, Any]:
    """The numbers of one cycle, over no dimension but ``multiplier``."""
    names = (*system.states, *system.outputs)
    n = system.traced.size
    if cycle is None:
        bare = {"period": np.nan, "residual": np.nan, "stable": 0}
        bare |= {f"{name}{end}": np.nan for name in names for end in ("_min", "_max")}
        return bare | dict.fromkeys(
            ("multiplier_real", "multiplier_imag"), np.full(n, np.nan)
        )
    cells: dict[str, Any] = {
        "period": cycle.period * cycle.second,
        "residual": cycle.residual,
    }
    extremes = cycle.extremes * cycle.map.flow.scale_of(*names)
    for name, (low, high) in zip(names, extremes.T, strict=True):
        cells |= {f"{name}_min": low, f"{name}_max": high}
    cells["stable"] = int(cycle.is_stable)
    multipliers = cycle.multipliers
    return cells | {
        "multiplier_real": multipliers.real,
        "multiplier_imag": multipliers.imag,
    }


def described(name: str, system: System) -> dict[str, str]:
    """long_name and units of a number of a cycle."""
    units = {**system.units, **{n: unit for n, (unit, _) in system.outputs.items()}}
    for end, word in (("_min", "smallest"), ("_max", "largest")):
        if name.endswith(end) and name.removesuffix(end) in units:
            short = name.removesuffix(end)
            return {
                "long_name": f"{word} {short} over the period",
                "units": units[short],
            }
    return {
        "period": {"long_name": "period", "units": "s"},
        "residual": {
            "long_name": "largest residual of the equations, without units",
            "units": "1",
        },
        "multiplier_real": {
            "long_name": "real part of the Floquet multipliers",
            "units": "1",
        },
        "multiplier_imag": {
            "long_name": "imaginary part of the Floquet multipliers",
            "units": "1",
        },
    }[name]


def outcome_of(system: System, dims: Any, values: Any) -> Any:
    """Return the outcome of a search for a cycle, with the system's own stops and motions of more
    periods.
    """
    table = flag_table(Outcome)
    more = np.unique(np.asarray(values)[np.asarray(values) > SETTLED_ON])
    table |= {int(k): f"settled_on_{int(k) - SETTLED_ON}_periods" for k in more}
    return explained(system, "how the cycle was found", dims, values, table)


def describe_columns(
    system: System, rows: Sequence[Mapping[str, Any]], dim: str | None = None
) -> dict[str, Any]:
    """Numbers of some cycles as variables, over a dimension if there is one."""
    variables: dict[str, Any] = {}
    over = (dim,) if dim else ()
    for name, bare in (rows[0] if rows else columns(None, system)).items():
        stacked = np.array([row[name] for row in rows]).reshape(-1, *np.shape(bare))
        values = stacked if dim else stacked[0]
        if name == "stable":
            table = {0: "no", 1: "yes"}
            variables[name] = flag(
                "whether small disturbances decay", over, values, table
            )
        else:
            dims = (*over, "multiplier") if np.ndim(bare) else over
            variables[name] = dims, values, described(name, system)
    return variables


def dataset(
    system: System,
    cycle: Cycle | None,
    outcome: int,
    values: Mapping[str, float],
    periods: int,
) -> xr.Dataset:
    """A cycle, or the reason why there is none, as a dataset."""
    variables = describe_columns(system, [columns(cycle, system)])
    number = outcome - SETTLED_ON if outcome > SETTLED_ON else periods
    label = labels("forcing periods, or returns to the section", "1")
    variables["periods"] = ((), number, label)
    times, order = np.empty(0), []
    instants, path, regime = np.empty(0), np.empty((0, len(system.states))), 0
    units = np.ones(len(system.states))
    if cycle is not None:
        ends = (cycle.clocks + cycle.parts.durations - cycle.phase) % cycle.period
        order = [i for i in np.argsort(ends) if cycle.map.events[i].switch != FREE]
        times = ends[order]
        instants = cycle.instants
        path, _ = cycle.states_at((cycle.phase + instants) % cycle.period)
        regime = cycle.start()[1]
        units = cycle.map.flow.scale_of(*system.states)
        path, times, instants = (
            path * units,
            times * cycle.second,
            instants * cycle.second,
        )
    chosen = [cycle.map.events[i] for i in order] if cycle else []
    states = np.array([cycle.parts.crossings[i].after for i in order] if cycle else [])
    states = states.reshape(-1, len(system.states)) * units
    kinds, names = dict(enumerate(system.traced.kinds)), dict(enumerate(system.regimes))
    joint = system.joint
    variables["event_time"] = ("event", times, labels("time of the event", "s"))
    variables["event_kind"] = named(
        "kind of the event", "event", [e.kind for e in chosen], kinds
    )
    variables["event_regime"] = named(
        "regime entered",
        "event",
        [joint.entered_by(e.after, e.switch) for e in chosen],
        names,
    )
    for i, name in enumerate(system.states):
        unit = system.units[name]
        variables[f"event_{name}"] = (
            "event",
            states[:, i],
            labels(f"{name} after it", unit),
        )
        variables[f"{name}_path"] = (
            "sample",
            path[:, i],
            labels(f"{name} along the cycle", unit),
        )
        first = path[0, i] if len(path) else np.nan
        variables[f"{name}_start"] = (
            (),
            first,
            labels(f"{name} at t = 0 of the cycle", unit),
        )
    variables["start_regime"] = regime_flag(
        system, "regime at t = 0 of the cycle", (), np.array(joint.regimes(regime))
    )
    variables["time"] = ("sample", instants, labels("time", "s"))
    variables["outcome"] = outcome_of(system, (), outcome)
    return xr.Dataset(
        variables,
        components_of(system),
        attributes_of(system, "limit cycle", values, 1e-14)
        | {"closing_tolerance": CycleAccuracy.closing},
    )
