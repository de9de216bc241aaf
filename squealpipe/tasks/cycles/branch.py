"""Branches of periodic motions of model A1 in a parameter or an angle."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import xarray as xr
from annotated_types import Ge
from pydantic import BeforeValidator

from squealpipe.methods.continuation import ContinuationSettings, ContinuationState
from squealpipe.methods.cycles.branch_ends import (
    BranchEnd,
    BranchPoint,
    CycleBranchSettings,
)
from squealpipe.methods.cycles.cycle_branch import follow_cycles
from squealpipe.methods.cycles.cycle_equations import CycleEquations, cycle_algorithm
from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.labels import Label
from squealpipe.parameters import TABLE, Parameters, is_finite_number
from squealpipe.schema import Outcome, build
from squealpipe.schema.cycles import CYCLE_BRANCH, LIMIT_CYCLE
from squealpipe.schema.origin import recorded
from squealpipe.solvers.a1.flow import A1Flow
from squealpipe.tasks.cycles.cycle import (
    T_SETTLE,
    cycle_values,
    find_cycle,
    settled_state,
    slow_time,
)
from squealpipe.tasks.cycles.onset import find_onset
from squealpipe.validation import Angle, Number, Whole, state_of

ENDS = {
    BranchEnd.arrived: Outcome.converged,
    BranchEnd.returned: Outcome.returned,
    BranchEnd.lost: Outcome.branch_lost,
    BranchEnd.point_limit: Outcome.point_limit,
    BranchEnd.at_rest: Outcome.equilibrium,
    BranchEnd.closed: Outcome.closed,
    BranchEnd.retraced: Outcome.retraced,
    BranchEnd.shorter: Outcome.tongue_end,
    BranchEnd.singular: Outcome.singular_geometry,
    BranchEnd.tangency: Outcome.tangency,
}


def _start(value: Any) -> Any:
    if isinstance(value, xr.Dataset) or (isinstance(value, str) and value == "onset"):
        return value
    try:
        return state_of(value)
    except ValueError as error:
        raise ValueError("a state (x, y, vx, vy), a dataset or 'onset' is needed") from error


Start = Annotated[Any, BeforeValidator(_start)]
_SAME_VALUE = 1e-11
"""Two values of a parameter as close as this, relative, are one to a branch."""
_STATE = ("x", "y", "vx", "vy")


@recorded(model="A1", method="pseudo-arclength continuation of the return map")
def cycle_branch(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    parameter: str,
    to: Number,
    start: Start | None = None,
    n_points: Annotated[Whole, Ge(2)] = 200,
    doubled: bool = False,
) -> xr.Dataset:
    """The branch of cycles through a start, in one parameter, stable and unstable parts.

    Pseudo-arclength continuation that goes round folds and corners. A step holds at most one
    change of the events; folds, period doublings, torus bifurcations, grazings, and stick that
    just begins, ends or is interrupted, are located and become points of their own. Events that
    coincide, as where contact is lost at belt speed, make no special point.

    Args:
        params: physical parameters; their value of ``parameter`` is where the branch starts.
        alpha1, alpha2: angles, rad.
        parameter: name of a physical parameter, "alpha1" or "alpha2".
        to: value at which the branch ends with ``converged``. It may end before: where the
            parameter comes back to its value at the start (``returned``), where the branch is a
            closed curve (``closed``), meets a cycle of half the period or a third of it
            (``tongue_end``), shrinks to a state of rest (``equilibrium``), comes to a pivot
            (``singular_geometry``), where the mass just touches belt speed or the limit of stick
            and would jump (``tangency``), or where it cannot be followed (``branch_lost``).
        start: a state (x, y, ẋ, ẏ) near the first cycle, a dataset of ``limit_cycle``, "onset" (the
            loss of stability of steady sliding between the two values), or None: a settled run.
        n_points: largest number of points; a branch that goes on ends with ``point_limit``.
        doubled: follow the branch that leaves at the first period doubling instead.

    Returns:
        Dataset over ``point``, with a variable named like the parameter; ``label`` says what is
        special about a point, "end" at the last one, and ``end`` why the branch ended there.

    Raises:
        ValueError: an argument is not allowed.
    """
    begin = _value(params, alpha1, alpha2, parameter)
    _check(params, parameter, begin, to)

    def system_at(value: float) -> A1Flow:
        return _system(params, alpha1, alpha2, parameter, value, unit)

    unit = max(abs(begin), abs(to))
    settings = CycleBranchSettings(low=min(begin, to), high=max(begin, to), max_points=n_points)
    steps = ContinuationSettings(
        first_step=1e-3,
        shortest_step=1e-8,
        longest_step=0.03,
        tolerance=1e-11,
        stagnant=1e-9,
        max_points=n_points,
    )
    if isinstance(start, str):
        first = find_onset(system_at, begin, to, unit, steps)
        outcome = Outcome.no_convergence if first is None else Outcome.converged
    else:
        cycle, outcome = _first_cycle(system_at(begin), start)
        first = None if cycle is None else _direction(cycle, system_at, begin, to, unit, steps)
    if first is None:
        return _dataset([], outcome, (alpha1, alpha2), parameter)
    equations, state = first
    points, end = follow_cycles(equations, state, settings, steps)
    if doubled:
        return _dataset(
            *_doubled(points, system_at, unit, settings, steps),
            (alpha1, alpha2), parameter,
        )  # fmt: skip
    return _dataset(points, ENDS[end], (alpha1, alpha2), parameter)


def _check(params: Parameters, parameter: str, begin: float, to: float) -> None:
    if math.isclose(to, begin, rel_tol=_SAME_VALUE):
        raise ValueError(
            f"to = {to!r}: a finite value other than {parameter} = {begin!r}, the start, is needed"
        )
    if parameter not in ("alpha1", "alpha2"):
        params.with_(**{parameter: to})


def _value(params: Parameters, alpha1: float, alpha2: float, parameter: str) -> float:
    values = {name: getattr(params, name) for name, row in TABLE.items() if row.enters_a1}
    values |= {"alpha1": alpha1, "alpha2": alpha2}
    if not is_finite_number(values.get(parameter)):
        known = ", ".join(name for name, value in values.items() if is_finite_number(value))
        unread = parameter in TABLE and parameter not in values
        why = " (A1 does not read it)" if unread else ""
        raise ValueError(f"parameter = {parameter!r}{why}: one of {known} is needed")
    return float(values[parameter])


def _system(
    params: Parameters, alpha1: float, alpha2: float, parameter: str, value: float, unit: float
) -> A1Flow:
    angles = {"alpha1": alpha1, "alpha2": alpha2}
    if parameter in angles:
        angles[parameter] = value
    else:
        params = params.with_(**{parameter: value})
    return A1Flow(params, **angles, follow=parameter, unit=unit)


def _first_cycle(system: A1Flow, start: Any) -> tuple[Cycle | None, Outcome]:
    if start is None:
        settled, outcome = settled_state(system, T_SETTLE * slow_time(system.params))
        if settled is None:
            return None, outcome
        state = settled
    elif isinstance(start, xr.Dataset):
        if start.attrs.get("schema") != LIMIT_CYCLE.name:
            raise ValueError(
                f"start holds {', '.join(map(str, start.data_vars)) or 'nothing'}: a dataset of "
                "limit_cycle is needed"
            )
        if Outcome(int(start.outcome)) not in {Outcome.converged, Outcome.family_member}:
            return None, Outcome(int(start.outcome))
        state = np.array([float(start[f"{name}_start"]) for name in _STATE])
    else:
        state = start
    return find_cycle(system, state)


def equations_at(cycle: Cycle, system_at: Callable[[float], A1Flow], unit: float) -> CycleEquations:
    """The return map around a cycle, scaled by it."""
    return CycleEquations(
        system_at=system_at,
        scale=cycle.scale,
        time=cycle.period,
        unit=unit,
        reference=cycle.state,
        normal=cycle.heading / np.linalg.norm(cycle.heading),
    )


def _direction(
    cycle: Cycle,
    system_at: Callable[[float], A1Flow],
    begin: float,
    to: float,
    unit: float,
    steps: ContinuationSettings,
) -> tuple[CycleEquations, ContinuationState] | None:
    """The branch's tangent at its first cycle, towards ``to``."""
    equations = equations_at(cycle, system_at, unit)
    point = equations.pack(cycle.state, cycle.period, begin)
    ahead = np.zeros(6)
    ahead[5] = math.copysign(1.0, to - begin)
    state = cycle_algorithm(steps).solve(equations, point, ahead, steps.first_step)
    return None if state is None else (equations, state)


def _doubled(
    points: list[BranchPoint],
    system_at: Callable[[float], A1Flow],
    unit: float,
    settings: CycleBranchSettings,
    steps: ContinuationSettings,
) -> tuple[list[BranchPoint], Outcome]:
    """The branch of twice the period from the first period doubling."""
    for point in points:
        if point.label != Label.period_doubling:
            continue
        cycle = replace(point.cycle, period=2.0 * point.cycle.period)
        values, vectors = np.linalg.eig(
            point.cycle.passage.derivative * cycle.scale / cycle.scale[:, None]
        )
        flip = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
        equations = equations_at(cycle, system_at, unit)
        start = equations.pack(cycle.state, cycle.period, point.parameter)
        direction = np.zeros(6)
        direction[:4] = flip - equations.normal * (equations.normal @ flip)
        direction /= np.linalg.norm(direction)
        algorithm = cycle_algorithm(steps)
        for length in (1e-3, 3e-3, 1e-2):
            guess = start + length * direction
            state = algorithm.solve(equations, guess, direction, steps.first_step)
            if state is not None:
                followed, end = follow_cycles(equations, state, settings, steps)
                return followed, ENDS[end]
    return [], Outcome.no_doubling


def _dataset(
    points: list[BranchPoint],
    end: Outcome,
    angles: tuple[float, float],
    parameter: str,
) -> xr.Dataset:
    rows = [cycle_values(point.cycle) for point in points]
    names = ("multiplier_real", "multiplier_imag")
    empty: dict[str, Any] = {name: np.empty((0, 4)) for name in names}
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else empty
    if not rows:
        scalars = [
            name
            for name, entry in CYCLE_BRANCH.variables.items()
            if entry.dims == ("point",) and not entry.optional
        ]
        columns |= {name: np.empty(0) for name in scalars}
    states = np.array([point.cycle.state for point in points]).reshape(-1, 4)
    followed = np.array([point.parameter for point in points])
    fixed = {"alpha1": angles[0], "alpha2": angles[1]}
    outcomes = [
        Outcome.family_member if point.cycle.is_family_member else Outcome.converged
        for point in points
    ]
    return build(
        CYCLE_BRANCH,
        {
            **columns,
            **{name: np.full(len(points), value) for name, value in fixed.items()},
            parameter: followed,
            "label": [point.label for point in points],
            "events": [len(point.cycle.passage.event_kinds) for point in points],
            **{f"{name}_start": states[:, i] for i, name in enumerate(_STATE)},
            "outcome": outcomes,
            "end": end,
        },
        {"multiplier": np.arange(1, 5), "point": np.arange(len(points))},
        {"parameter": parameter},
    )
