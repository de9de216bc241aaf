"""Branches of cycles in one parameter, stable and unstable, with located special points.

:mod:`squealpipe.systems.cycles.following` makes the steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.systems.branch_labels import Label
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.described import by_table, columns, outcome_of
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.following import Follower
from squealpipe.systems.cycles.line import at_special_points, branch_steps
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.cycles.trail import BranchPoint
from squealpipe.systems.datasets import Outcome, flag_table
from squealpipe.systems.inputs.gate import Number, Several, checked
from squealpipe.systems.labels import build, flag, regime_flag

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


@checked
def cycle_branch(
    system: Any, parameter: str, to: Number, *, start: Any, n_points: Several = 100
) -> xr.Dataset:
    """The branch of cycles through a start, in one parameter, stable and unstable parts.

    It goes round folds and through changes of the order of events. Folds, pitchforks (where two
    branches cross without a symmetry: transcritical points), period doublings, torus bifurcations,
    grazings and onsets of stick are located and are points of their own, and so is a
    ``border_collision``: any other change of the events at which the stability jumps. A branch that
    goes on at one value of the parameter alone is a family of cycles: there it ends with a point
    ``family_member``.

    Args:
        to: value at which the branch ends.
        start: a dataset of ``limit_cycle`` or one point of a branch; the other parameters are its.

    Returns:
        Dataset over ``point`` with what :func:`limit_cycle` gives of a cycle, a variable of the
        parameter's name, ``label``, ``events`` (their number) and ``end``, why the branch ended.
        A special point has the stability of the point before it; a grazing and an onset of
        sticking, where the return map has no derivative, have no multipliers (NaN).
    """
    system.check_parameter(parameter)
    cycle = started(system, start)
    begin = cycle.parameters[parameter]
    if math.isclose(to, begin, rel_tol=1e-11):
        raise ValueError(f"to = {to!r}: another value than that of the start is needed")
    low, high = (-math.inf, to) if to > begin else (to, math.inf)
    first = first_point(cycle, parameter, to)
    scale = cycle.scale_of(parameter)
    follower = Follower(low / scale, high / scale, n_points)
    end = Outcome.no_convergence if first is None else follower.run(*first)
    return dataset(system, follower.points, end, parameter)


def started(system: System, start: xr.Dataset) -> Cycle:
    """The cycle of a dataset."""
    import json

    names = [f"{name}_start" for name in system.states]
    if not isinstance(start, xr.Dataset) or any(name not in start for name in names):
        raise ValueError(
            "start: a dataset of limit_cycle or one point of a branch is needed"
        )
    if start[names[0]].ndim:
        raise ValueError("start has many points; give one, as start.isel(point=…)")
    values = {**system.parameters, **json.loads(start.attrs["parameters"])}
    values |= {name: float(start[name]) for name in system.parameters if name in start}
    state = np.array([float(start[name]) for name in names])
    if not np.isfinite(state).all():
        raise ValueError("start holds no cycle")
    cycle, _ = find_cycle(
        system,
        values,
        state,
        guess=True,
        periods=int(start["periods"]),
        regime=system.joint.number(np.atleast_1d(start["start_regime"]).tolist()),
    )
    if cycle is None:
        raise ValueError("no cycle is found from start")
    return cycle


def first_point(
    cycle: Cycle, parameter: str, to: float
) -> tuple[ContinuationState, Cycle] | None:
    """A cycle as a point of its branch, with a tangent towards a value of the parameter."""
    begin, to = cycle.parts.values[parameter], to / cycle.scale_of(parameter)
    flow = cycle.map.flow.following(parameter)
    equations, guess = cycle.followed_in(flow, np.array([max(abs(begin), abs(to))]))
    normal = math.copysign(1.0, to - begin) * np.eye(len(guess))[-1]
    state = at_special_points.solve(equations, guess, normal, branch_steps.first_step)
    return None if state is None else (state, Cycle.at(equations, state.point))


def in_rows(
    points: list[BranchPoint], numbers: Callable[[Cycle], dict[str, Any]]
) -> list[dict[str, Any]]:
    """The numbers of each point of a branch.

    A special point has the stability of the point before it, as round-off would decide where a
    multiplier is on the unit circle. At a grazing and at an onset of sticking the return map has no
    derivative, so there are no multipliers.
    """
    rows = [numbers(point.cycle) for point in points]
    for i, (row, point) in enumerate(zip(rows, points, strict=True)):
        if point.label not in {Label.regular, Label.end}:
            isolated = point.label != Label.family_member
            row["stable"] = rows[max(i - 1, 0)]["stable"] if isolated else 0
        # the return map has no derivative there
        if point.label in {Label.grazing, Label.stick_onset, Label.border_collision}:
            row |= {
                name: row[name] * np.nan
                for name in ("multiplier_real", "multiplier_imag")
            }
    return rows


def dataset(
    system: System, points: list[BranchPoint], end: int, parameter: str
) -> xr.Dataset:
    """A branch as a dataset."""
    rows = in_rows(points, lambda cycle: columns(cycle, system))
    starts = [point.cycle.start() for point in points]
    units = points[0].cycle.map.flow.scale_of(*system.states) if points else 1.0
    states = np.array([state for state, _ in starts]).reshape(-1, system.traced.size)
    regimes = np.array([system.joint.regimes(regime) for _, regime in starts], int)
    followed = [p.parameter * p.cycle.scale_of(parameter) for p in points]
    return build(
        system,
        "cycle branch",
        {
            **by_table(system, rows, many=True),
            "<parameter>": {parameter: followed},
            "label": flag([point.label for point in points], flag_table(Label)),
            "events": [len(point.cycle.events) for point in points],
            "<state>_start": dict(zip(system.states, (states * units).T, strict=True)),
            "start_regime": regime_flag(
                system, regimes.reshape(len(starts), system.traced.n_components)
            ),
            "periods": points[0].cycle.map.periods or 1 if points else 1,
            "outcome": outcome_of(system, np.zeros(len(points), int)),
            "end": outcome_of(system, int(end)),
        },
        {},
        points[0].cycle.parameters if points else {},
        1e-14,
        parameter=parameter,
    )
