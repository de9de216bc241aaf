"""A cycle from a start or near a guess, forced or not."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from squealpipe.systems.cycles.admissible import margins
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.forced import near_forced, settled_forced
from squealpipe.systems.cycles.free import near_free, settled_free
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.datasets import Outcome
from squealpipe.systems.integrate import MOST_STEPS
from squealpipe.systems.trace import TIME

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


def find_cycle(
    system: System,
    values: Mapping[str, float],
    state: Vector,
    *,
    guess: bool,
    periods: int = 1,
    t_settle: float | None = None,
    regime: int | None = None,
    unit: float | None = None,
    most_steps: int = MOST_STEPS,
) -> tuple[Cycle | None, int]:
    """A cycle from a start or near a guess, and an outcome: above 200, of that many periods more.

    Args:
        values, state: in the system's units; the cycle has them in its scales, if it states any.
        periods: of the forcing, or returns to the section; 0 for any number.
        t_settle: s.
        unit: of time, s, in which a run settles and returns are looked for; by default the
            system's.
        most_steps: of each run.
    """
    flow, values = Flow.of(system, values)
    state, second = state / flow.scale_of(*system.states), flow.scale_of(TIME)[0]
    t_settle = None if t_settle is None else t_settle / second
    forced = system.period is not None and flow.timed
    unit = flow.unit(values) if unit is None else unit / second
    if not guess:
        solution = (
            settled_forced(flow, values, state, periods, t_settle, most_steps)
            if forced
            else settled_free(flow, values, state, periods, t_settle, unit, most_steps)
        )
        return labelled(*solution)

    def near(at: Mapping[str, float]) -> tuple[Cycle | None, int]:
        if forced:
            return near_forced(flow, at, state, regime, periods)
        return near_free(flow, at, state, regime, unit, most_steps)

    cycle, outcome = near(values)
    if outcome == Outcome.no_convergence:
        # at the very onset of stick, or a touch, round-off decides how a run goes on
        besides = (near(each)[0] for each in _beside(values))
        back = (_brought(each, values) for each in besides if each is not None)
        cycle = next((each for each in back if each is not None), None)
        outcome = outcome if cycle is None else Outcome.converged
    return labelled(cycle, outcome)


def labelled(cycle: Cycle | None, outcome: int) -> tuple[Cycle | None, int]:
    """The outcome of a member of a family says so, and of one whose stability is not known."""
    if cycle is not None and not cycle.keeps_its_direction:
        return cycle, Outcome.unresolved
    member = cycle is not None and cycle.is_family_member
    return cycle, Outcome.family_member if member else outcome


def _beside(values: Mapping[str, float]) -> Iterator[dict[str, float]]:
    """Parameters next to these at both sides, each changed by another share.

    Changed alike, all forces of a system may keep their proportions.
    """
    shares = np.linspace(1.0, 2.0, max(len(values), 2))
    # relative change of the parameters next to a change of the events
    beside = 1e-9
    for sign in (-beside, beside):
        yield {
            name: value * (1.0 + sign * share)
            for (name, value), share in zip(values.items(), shares, strict=False)
        }


def _brought(cycle: Cycle, values: Mapping[str, float]) -> Cycle | None:
    """A cycle next to these parameters at them."""
    equations = replace(cycle.map, values=dict(values))
    point = equations.solve(cycle.point)
    if point is None:
        return None
    there = Cycle.at(equations, point)
    # a cycle whose margin is below zero by less is at the change
    return there if min(margins(there).values(), default=1.0) > -1e-6 else None
