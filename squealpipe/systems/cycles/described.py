"""Cycles as the variables of datasets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.solution import Cycle, CycleAccuracy
from squealpipe.systems.datasets import Outcome, flag_table
from squealpipe.systems.labels import Flags, build, explained, flag, named, regime_flag

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


def outcome_of(system: System, values: Any) -> Flags:
    """Return the outcome of a search for a cycle, with the system's own stops and motions of more
    periods.
    """
    table = flag_table(Outcome)
    more = np.unique(np.asarray(values)[np.asarray(values) > SETTLED_ON])
    table |= {int(k): f"settled_on_{int(k) - SETTLED_ON}_periods" for k in more}
    return explained(system, values, table)


def by_table(
    system: System, rows: Sequence[Mapping[str, Any]], *, many: bool
) -> dict[str, Any]:
    """Return the numbers of some cycles by the names of the table, or those of one cycle."""
    stacked = {
        name: np.array([row[name] for row in rows]).reshape(-1, *np.shape(bare))
        for name, bare in (rows[0] if rows else columns(None, system)).items()
    }
    values = stacked if many else {name: each[0] for name, each in stacked.items()}
    names = (*system.states, *system.outputs)
    content: dict[str, Any] = {
        f"<name>{end}": {name: values.pop(f"{name}{end}") for name in names}
        for end in ("_min", "_max")
    }
    content["stable"] = flag(values.pop("stable"), {0: "no", 1: "yes"})
    return content | values


def dataset(
    system: System,
    cycle: Cycle | None,
    outcome: int,
    values: Mapping[str, float],
    periods: int,
) -> xr.Dataset:
    """A cycle, or the reason why there is none, as a dataset."""
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
    first = path[0] if len(path) else np.full(len(system.states), np.nan)
    kinds, names = dict(enumerate(system.traced.kinds)), dict(enumerate(system.regimes))
    joint = system.joint
    entered = [joint.entered_by(each.after, each.switch) for each in chosen]
    return build(
        system,
        "limit cycle",
        {
            **by_table(system, [columns(cycle, system)], many=False),
            "periods": outcome - SETTLED_ON if outcome > SETTLED_ON else periods,
            "event_time": times,
            "event_kind": named([each.kind for each in chosen], kinds),
            "event_regime": named(entered, names),
            "event_<state>": dict(zip(system.states, states.T, strict=True)),
            "<state>_path": dict(zip(system.states, path.T, strict=True)),
            "<state>_start": dict(zip(system.states, first, strict=True)),
            "start_regime": regime_flag(system, np.array(joint.regimes(regime))),
            "time": instants,
            "outcome": outcome_of(system, outcome),
        },
        {},
        values,
        1e-14,
        closing_tolerance=CycleAccuracy.closing,
    )
