"""Derivatives of a run by parameters and starts, through its events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.guess import events_of
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.variational import leg_derivatives
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.labels import labels
from squealpipe.systems.record import RunRecord

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


def sensitivities(
    system: System,
    names: Sequence[str],
    values: Mapping[str, float],
    motion: RunRecord,
    times: Vector,
    t_start: float = 0.0,
) -> dict[str, Any]:
    """``<state>_by_<name>`` over ``time`` and ``event_time_by_<name>`` over ``event``.

    The derivative of a state is at a fixed instant; an event's that of its time.

    Args:
        names: of parameters, and ``<state>0`` for starts.
        values: of states at the start and parameters.
        motion: the run, with its states at ``times``.
        t_start: when it begins.
    """
    starts = list(system.start_names.values())
    known = [*system.parameters, *starts]
    for name in names:
        if name not in known:
            raise ValueError(
                f"sensitivity: {name!r} is unknown; {suggestion(name, known)}"
            )
    flow = Flow(system, [name for name in names if name in system.parameters])
    n, count = flow.size, len(motion.times)
    columns = [i for i, name in enumerate(names) if name in system.parameters]
    total = np.array([[float(start == name) for name in names] for start in starts])
    states = np.array([values[state] for state in system.states])
    by_time = np.full((len(times), n, len(names)), np.nan)
    delays = np.full((count, len(names)), np.nan)
    events = events_of(system, motion, 0, count)
    stops = [(time, 0, i) for i, time in enumerate(motion.times)]
    stops += [(time, 1, i) for i, time in enumerate(times) if time <= motion.reached]
    stops.sort()
    legs: list[tuple[float, Vector, int]] = []
    clock, regime = t_start, int(motion.regimes[0])
    for time, sampled, i in stops:
        legs.append((clock, states, regime))
        clock = time
        states = motion.path[i] if sampled else motion.states[i]
        regime = regime if sampled else int(motion.regimes[i + 1])
    # legs that are run at once: memory grows with them
    together = 64
    for first in range(0, len(stops), together):
        part = legs[first : first + together]
        begins = np.array([leg[0] for leg in part])
        lengths = (
            np.array([stop[0] for stop in stops[first : first + together]]) - begins
        )
        path = flow.run(
            values,
            np.array([leg[1] for leg in part]),
            [leg[2] for leg in part],
            begins,
            lengths,
        )
        slopes = leg_derivatives(flow, values, path)
        for leg, (time, sampled, i) in enumerate(stops[first : first + together]):
            total = slopes[leg][:, :n] @ total
            total[:, columns] += slopes[leg][:, n : n + len(columns)]
            if sampled:
                by_time[i] = total
                continue
            event = events[i]
            crossing = flow.crossing(
                values,
                event.switch,
                event.surface,
                (event.before, event.after),
                path.ends[leg],
                time,
            )
            along = crossing.height_by_state @ total
            along[columns] += crossing.height_by
            delays[i] = -along / crossing.speed
            beyond = crossing.is_beyond(path.ends[leg], system.sizes_in(values))
            if lengths[leg] == 0.0 and beyond:
                delays[i] = delays[i - 1] if i else 0.0
            total = crossing.after_by_state @ total + np.outer(crossing.jump, delays[i])
            total[:, columns] += crossing.after_by
    found: dict[str, Any] = {}
    for j, name in enumerate(names):
        for k, state in enumerate(system.states):
            label = labels(
                f"derivative of {state} by {name}", f"{system.units[state]} / {name}"
            )
            found[f"{state}_by_{name}"] = ("time", by_time[:, k, j], label)
        label = labels(f"derivative of the time of the event by {name}", f"s / {name}")
        found[f"event_time_by_{name}"] = ("event", delays[:, j], label)
    return found
