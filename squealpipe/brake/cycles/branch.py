"""Follow branches of periodic motions of model A1 in a parameter or an angle.

Idea: the first cycle comes from a settled run, a given state or the onset of steady sliding's
instability; the branch is then followed by the pseudo-arclength continuation of systems
(:mod:`squealpipe.systems.cycles.following`). Source: H. B. Keller, in Applications of Bifurcation
Theory (1977). Invariant: every point is a motion of A1 with its events located, and ``end`` says
why there are no more. Cost: that of the points, and of a settled run if no start is given.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
import xarray as xr
from annotated_types import Ge
from pydantic import BeforeValidator

from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.cycles.cycle import (
    IN_SYSTEM,
    cycle_from,
    is_next_to_pivot,
    n_events,
    numbers,
    start_of,
)
from squealpipe.brake.cycles.onset import find_onset
from squealpipe.brake.models.refusals import refuse_unread
from squealpipe.brake.schema.cycles import a1_cycle_branch_schema, a1_limit_cycle_schema
from squealpipe.parameters import TABLE, Parameters
from squealpipe.schema import Outcome, blank, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.branch import first_point, in_rows
from squealpipe.systems.cycles.doubling import doubled_start
from squealpipe.systems.cycles.following import Follower
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.cycles.trail import BranchPoint
from squealpipe.systems.inputs.values import is_finite_number
from squealpipe.systems.integrate import MOST_STEPS
from squealpipe.validation import Angle, Natural, Number, Whole, state_of


def _start(value: Any) -> Any:
    if isinstance(value, xr.Dataset) or (isinstance(value, str) and value == "onset"):
        return value
    try:
        return state_of(value)
    except ValueError as error:
        raise ValueError(
            "a state (x, y, vx, vy), a dataset or 'onset' is needed"
        ) from error


Start = Annotated[Any, BeforeValidator(_start)]


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
    max_steps: Natural = MOST_STEPS,
) -> xr.Dataset:
    """Return the branch of cycles through a start in one parameter, stable and unstable parts.

    Pseudo-arclength continuation goes round folds and corners. A step holds at most one
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
        max_steps: steps of the integrator in a run to the first cycle, after which ``end`` is
            ``step_limit``.

    Returns:
        Dataset over ``point``, with a variable named like the parameter; ``label`` says what is
        special about a point, "end" at the last one, and ``end`` why the branch ended there.
    """
    begin = _value(params, alpha1, alpha2, parameter)
    # two values of a parameter as close as this, relative, are one to a branch
    same_value = 1e-11
    if math.isclose(to, begin, rel_tol=same_value):
        raise ValueError(
            f"to = {to!r}: a finite value other than {parameter} = {begin!r}, the start, is needed"
        )
    if parameter not in ("alpha1", "alpha2"):
        params.with_(**{parameter: to})
    design = Design(params, alpha1, alpha2)
    outcome = Outcome.no_convergence
    if isinstance(start, str):
        first = find_onset(design, parameter, begin, to)
    else:
        cycle, outcome = _first_cycle(design, parameter, start, max_steps)
        first = None
        if cycle is not None:
            first = first_point(cycle, IN_SYSTEM[parameter], to)
            outcome = Outcome.no_convergence
    if first is None:
        return _dataset(design, parameter, [], outcome)
    scale = first[1].scale_of(IN_SYSTEM[parameter])
    low, high = sorted((begin / scale, to / scale))
    follower = Follower(low, high, n_points)
    end = follower.run(*first)
    if doubled:
        flips = (p for p in follower.points if p.label == Label.period_doubling)
        first = next((found for p in flips if (found := doubled_start(p))), None)
        if first is None:
            return _dataset(design, parameter, [], Outcome.no_doubling)
        follower = Follower(low, high, n_points)
        end = follower.run(*first)
    last = follower.points[-1]
    units = last.cycle.map.flow.scale_of("x", "y")
    places = last.cycle.parts.path.series[:, :2, 0] * units
    if end == Outcome.branch_lost and is_next_to_pivot(last.cycle.parameters, places):
        end = Outcome.singular_geometry
    elif end == Outcome.converged and math.isclose(
        last.parameter, begin / scale, rel_tol=1e-11
    ):
        end = Outcome.returned
    return _dataset(design, parameter, follower.points, end)


def _value(params: Parameters, alpha1: float, alpha2: float, parameter: str) -> float:
    values = {
        name: getattr(params, name) for name, row in TABLE.items() if row.enters_a1
    }
    values |= {"alpha1": alpha1, "alpha2": alpha2}
    if not is_finite_number(values.get(parameter)):
        known = ", ".join(
            name for name, value in values.items() if is_finite_number(value)
        )
        why = " (A1 does not read it)" if parameter in {*TABLE} - {*values} else ""
        raise ValueError(f"parameter = {parameter!r}{why}: one of {known} is needed")
    refuse_unread(params, [parameter])
    return float(values[parameter])


def _first_cycle(
    design: Design, parameter: str, start: Any, most_steps: int
) -> tuple[Cycle | None, Outcome]:
    if isinstance(start, xr.Dataset):
        if start.attrs.get("schema") != a1_limit_cycle_schema.name:
            raise ValueError(
                f"start holds {', '.join(map(str, start.data_vars)) or 'nothing'}: a dataset of "
                "limit_cycle is needed"
            )
        if Outcome(int(start.outcome)) not in {
            Outcome.converged,
            Outcome.family_member,
        }:
            return None, Outcome(int(start.outcome))
        start = np.array([float(start[f"{name}_start"]) for name in STATE])
    return cycle_from(design, start, most_steps=most_steps, varied=[parameter])


def _dataset(
    design: Design, parameter: str, points: list[BranchPoint], end: Outcome
) -> xr.Dataset:
    rows = in_rows(points, numbers)
    columns: dict[str, Any] = blank(a1_cycle_branch_schema, multiplier=4)
    if rows:
        columns |= {name: np.array([row[name] for row in rows]) for name in rows[0]}
    states = np.array([start_of(point.cycle) for point in points]).reshape(-1, 4)
    name = IN_SYSTEM[parameter]
    followed = [point.parameter * point.cycle.scale_of(name) for point in points]
    fixed = {"alpha1": design.alpha1, "alpha2": design.alpha2}
    outcomes = [
        Outcome.family_member if point.cycle.is_family_member else Outcome.converged
        for point in points
    ]
    return build(
        a1_cycle_branch_schema,
        {
            **columns,
            **{name: np.full(len(points), value) for name, value in fixed.items()},
            parameter: followed,
            "label": [point.label for point in points],
            "events": [n_events(point.cycle) for point in points],
            **{f"{name}_start": states[:, i] for i, name in enumerate(STATE)},
            "outcome": outcomes,
            "end": end,
        },
        {"multiplier": np.arange(1, 5), "point": np.arange(len(points))},
        {"parameter": parameter},
    )
