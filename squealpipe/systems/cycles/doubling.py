"""The branch of twice the period that leaves a branch of cycles at a period doubling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.line import along_branch, branch_steps
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.cycles.trail import BranchPoint


def doubled_start(point: BranchPoint) -> tuple[ContinuationState, Cycle] | None:
    """The first point of the branch of twice the period that leaves at a period doubling."""
    cycle = point.cycle
    equations, parts, n = cycle.map, cycle.parts, cycle.map.flow.size
    values, vectors = np.linalg.eig(cycle.monodromy)
    shift = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))]) * equations.scale
    shifts, delays = [], []
    for event, slopes, crossing in zip(
        equations.events, parts.slopes, parts.crossings, strict=True
    ):
        shifts.append(shift)
        moved = slopes[:, :n] @ shift
        hit = event.switch != FREE
        delays.append(
            -float(crossing.height_by_state @ moved) / crossing.speed if hit else 0.0
        )
        shift = crossing.saltation @ moved if hit else moved
    # a leg begins when the event before it comes, which is late by its own delay
    late = np.array([-delays[-1], *delays])
    lengths, starts = np.diff(late), []
    for leg, begun in enumerate(late[:-1]):
        event = equations.events[leg]
        rate = equations.flow.field(
            parts.values,
            event.before,
            parts.states[leg],
            parts.start + cycle.clocks[leg],
        )
        starts.append(shifts[leg] + rate * begun)
    twice = replace(
        equations, events=equations.events * 2, periods=2 * equations.periods
    )
    followed = cycle.followed
    base = twice.pack(
        np.tile(parts.states, (2, 1)),
        np.tile(parts.durations, 2),
        parts.start,
        followed,
    )
    direction = twice.pack(
        np.concatenate([starts, np.negative(starts)]),
        np.concatenate([lengths, -lengths]),
        float(late[0]),
        0.0 * followed,
    )
    if twice.section is not None:
        direction[:n] -= twice.section.normal * (twice.section.normal @ direction[:n])
    direction /= np.linalg.norm(direction)
    for length in (1e-3, 3e-3, 1e-2):
        state = along_branch.solve(
            twice, base + length * direction, direction, branch_steps.first_step
        )
        if state is not None:
            return state, Cycle.at(twice, state.point)
    return None
