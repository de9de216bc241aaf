"""Margins by which a solution of an event map is a motion of the system; the least one changes
next.

A solution is a motion while every margin is positive: each watched surface inside a leg and at
its ends, the speed at which each event's surface is crossed, the length of each leg, and the
conditions that chose the regime entered. Where one falls to zero the order of the events changes.
"""

from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from squealpipe.systems.branch_line import ZERO_ROUND_OFF
from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.solution import Cycle


class MarginKind(IntEnum):
    """Quantity that a margin measures."""

    touch = 0
    """the least of a surface inside a leg"""
    edge = 1
    """a surface at an end of a leg"""
    speed = 2
    """the crossing of an event's surface"""
    length = 3
    """the duration of a leg"""
    condition = 4
    """what chose the regime entered"""


class Margin(NamedTuple):
    """One margin: of a leg (or the event at its end) and a surface (or a condition)."""

    kind: MarginKind
    leg: int
    which: int


@lru_cache(maxsize=8)
def margins(cycle: Cycle) -> dict[Margin, float]:
    """All margins of a cycle, over the size of each quantity in it; infinite where none is near."""
    system, events = cycle.map.flow.system, cycle.map.events
    t, path, parts = system.traced, cycle.parts.path, cycle.parts
    first, count = len(t.variables), len(t.surfaces)
    by_margin: dict[Margin, float] = {}
    surfaces = path.series[:, first : first + count, 0]
    size = np.maximum(np.abs(surfaces).max(axis=0, initial=0.0), 1e-300)
    bounds = [path.ends_of(first + s) for s in range(count)]
    joint = system.joint
    for leg, event in enumerate(events):
        entry, duration = events[leg - 1], float(parts.durations[leg])
        if event.at_once:
            height = -event.sign * bounds[event.surface][0][leg]
            by_margin[Margin(MarginKind.edge, leg, event.surface)] = (
                height / size[event.surface]
            )
            by_margin |= _conditions(cycle, leg)
            continue
        known = joint.holds(entry.before) | joint.begins_at_zero(
            entry.before, event.before
        )
        for watched, sign in ((joint.falls, 1.0), (joint.rises, -1.0)):
            for s in np.flatnonzero(watched(event.before) >= 0):
                if t.clocks[s]:
                    by_margin |= _next_tick(cycle, leg, int(s), sign)
                    continue
                fresh = entry.surface == s or known[s]
                # a surface that a leg starts from is watched after the leg's first millionth
                # alone
                begin = 1e-6 * duration if fresh else 0.0
                inside = [
                    sign * turn.value
                    for turn in path.turns[first + s]
                    if turn.leg == leg
                    and turn.is_minimum == (sign > 0)
                    and turn.time > begin
                ]
                by_margin[Margin(MarginKind.touch, leg, int(s))] = (
                    min(inside, default=np.inf) / size[s]
                )
                ends = [] if fresh else [sign * bounds[s][0][leg]]
                if s != event.surface:
                    ends.append(sign * bounds[s][1][leg])
                if ends and event.surface != FREE:
                    by_margin[Margin(MarginKind.edge, leg, int(s))] = (
                        float(min(ends)) / size[s]
                    )
        if event.surface == FREE:
            continue
        crossing = parts.crossings[leg]
        # a switch's own surface falls, whatever the sign of the one that is shared
        by_margin[Margin(MarginKind.speed, leg, event.surface)] = (
            -crossing.speed * cycle.period / size[event.surface]
        )
        by_margin[Margin(MarginKind.length, leg, FREE)] = duration / cycle.period
        by_margin |= _conditions(cycle, leg)
    return by_margin


def _next_tick(
    cycle: Cycle, leg: int, surface: int, sign: float
) -> dict[Margin, float]:
    """Return how far a leg's end is from a clock's tick, if its surface was above zero before."""
    path, event = cycle.parts.path, cycle.map.events[leg]
    index = len(cycle.map.flow.system.traced.variables) + surface
    first, last = (sign * float(end[leg]) for end in path.ends_of(index))
    entered_by_it = cycle.map.events[leg - 1].surface == surface
    tops = [sign * turn.value for turn in path.turns[index] if turn.leg == leg]
    above = max([*tops, *[first] * (not entered_by_it)], default=-1.0) > 0.0
    if surface == event.surface or not above:
        return {}
    size = max(float(np.abs(path.series[:, index, 0]).max(initial=0.0)), 1e-300)
    return {Margin(MarginKind.edge, leg, surface): last / size}


def _conditions(cycle: Cycle, leg: int) -> dict[Margin, float]:
    """Return the conditions that chose the regime that a leg's event leads to."""
    event, conditions, number = cycle.map.events[leg], {}, 0
    if event.switch == FREE:
        return {}
    system = cycle.map.flow.system
    for regime, condition, kind in system.traced.switches[event.switch].targets:
        after = system.joint.entered(event.before, regime)
        chosen = (after, kind) == (event.after, event.kind)
        if condition is not None:
            if condition.varies:
                value = cycle.parts.crossings[leg].conditions[number]
                conditions[Margin(MarginKind.condition, leg, number)] = (
                    value if chosen else -value
                )
            number += 1
        if chosen:
            break
    return conditions


def is_motion(cycle: Cycle) -> bool:
    """Return whether a solution is a motion of the system, to round-off."""
    return all(value >= -ZERO_ROUND_OFF for value in margins(cycle).values())
