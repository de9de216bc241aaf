"""How the events of two neighbouring cycles differ, and where between them they change.

Both cycles are described by one phase condition, away from events, so that their events compare
from the first to the last.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squealpipe.methods.cycles.cycles import Cycle
from squealpipe.methods.cycles.event_flow import Touch

_EXCHANGES = ((2, 0), (2, 1), (1, 0))
"""(events that appear, events that vanish) of the changes that are known."""


@dataclass(frozen=True)
class EventChange:
    """One change of the events.

    Attributes:
        touch: what has happened.
        fewer, more: kinds of the events on either side.
        first: index in ``more`` of the first event that the other side does not have.
    """

    touch: Touch
    fewer: tuple[int, ...]
    more: tuple[int, ...]
    first: int

    def distance(self, cycle: Cycle) -> float:
        """Zero where the change is, positive with more events, negative with fewer; no unit.

        Raises:
            ArithmeticError: the cycle has neither of the two sequences of events.
        """
        kinds = tuple(cycle.passage.event_kinds)
        if kinds == self.more:
            return cycle.system.overlap(self.touch, cycle.passage, self.first)
        if kinds == self.fewer:
            clearance = cycle.system.clearance(self.touch, cycle.passage)
            return -clearance / cycle.system.unit_of(self.touch)
        raise ArithmeticError


def event_change(one: Cycle, other: Cycle) -> EventChange | None:
    """The single change between two cycles with different events; None where it is not one.

    Of several that fit, the one that both cycles are nearest to.
    """
    first, second = tuple(one.passage.event_kinds), tuple(other.passage.event_kinds)
    longer, shorter = (first, second) if len(first) > len(second) else (second, first)
    cycles = (one, other) if longer is first else (other, one)
    found: list[tuple[float, EventChange]] = []
    for appear, vanish in _EXCHANGES:
        if len(longer) - len(shorter) != appear - vanish:
            continue
        for place in range(len(longer) - appear + 1):
            after = place + appear, place + vanish
            if longer[:place] != shorter[:place] or longer[after[0] :] != shorter[after[1] :]:
                continue
            extra, missing = longer[place : after[0]], shorter[place : after[1]]
            touch = one.system.touch_of(extra, missing)
            if touch is not None:
                change = EventChange(touch, shorter, longer, place)
                found.append((_remoteness(change, *cycles), change))
    return min(found, key=lambda item: item[0])[1] if found else None


def _remoteness(change: EventChange, more: Cycle, fewer: Cycle) -> float:
    """Square of the time between the events on one side, and clearance on the other, relative."""
    times, first = more.passage.event_times, change.first
    meets = change.touch == Touch.meeting
    near = times[first - 1 if meets and first else first : first + 2]
    apart = min(np.diff(near), default=more.period) / more.period
    clearance = fewer.system.clearance(change.touch, fewer.passage)
    return float(apart**2 + clearance / fewer.system.unit_of(change.touch))


def same_events(one: Cycle, other: Cycle) -> bool:
    """Whether two cycles with one phase condition have the same events in the same order."""
    return one.passage.event_kinds == other.passage.event_kinds
