"""Derivatives of a run by parameters and starts, through its events."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.guess import events_of
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.variational import leg_derivatives
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.record import RunRecord
from squealpipe.systems.taylor.layout import LOST_ERROR

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
    """``<state>_by_<name>`` over time and ``event_time_by_<name>`` over events, by these names.

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
    flow = system.flow([name for name in names if name in system.parameters])
    columns = [i for i, name in enumerate(names) if name in system.parameters]
    total = np.array([[float(start == name) for name in names] for start in starts])
    by_time = np.full((len(times), flow.size, len(names)), np.nan)
    delays = np.full((len(motion.times), len(names)), np.nan)
    for _, event, i, late in carried(
        flow, values, motion, times, total, columns, t_start
    ):
        if event:
            delays[i] = late
        else:
            by_time[i] = total
    return {
        "<state>_by_<name>": {
            (state, name): by_time[:, k, j]
            for j, name in enumerate(names)
            for k, state in enumerate(system.states)
        },
        "event_time_by_<name>": dict(zip(names, delays.T, strict=True)),
    }


def growth(
    flow: Flow,
    values: Mapping[str, float],
    motion: RunRecord,
    times: Vector,
    tol: float,
) -> tuple[float, float]:
    """Return the logarithm of what a perturbation grows by in a run, and when an error is lost.

    Args:
        values: of states at the start and parameters.
        motion: the run, with its states at ``times``.
        tol: error whose horizon of predictability is asked for; NaN: it is not passed.
    """
    sizes, horizon, log_size = flow.sizes(values), np.nan, 0.0
    total = (sizes / np.sqrt(flow.size))[:, None]
    for time, *_ in carried(flow, values, motion, times, total, []):
        size = float(np.linalg.norm(total[:, 0] / sizes))
        log_size += np.log(size)
        total /= size
        if np.isnan(horizon) and log_size > np.log(LOST_ERROR / tol):
            horizon = time
    return float(log_size), horizon


def carried(
    flow: Flow,
    values: Mapping[str, float],
    motion: RunRecord,
    times: Vector,
    total: Vector,
    columns: Sequence[int],
    t_start: float = 0.0,
) -> Iterator[tuple[float, bool, int, Vector]]:
    """Carry derivatives of the state along a run, and stop at instants and after events.

    Args:
        values: of states at the start and parameters.
        motion: the run, with its states at ``times``.
        total: (states, many) derivatives at the start; changed in place.
        columns: of the followed parameters among them.

    Yields:
        The time, whether it is that of an event, which instant or event it is, and the derivatives
        of the event's time, (many,).
    """
    system, n = flow.system, flow.size
    state = np.array([values[name] for name in system.states])
    events = events_of(system, motion, 0, len(motion.times))
    stops = [(time, 0, i) for i, time in enumerate(motion.times)]
    stops += [(time, 1, i) for i, time in enumerate(times) if time <= motion.reached]
    stops.sort()
    legs: list[tuple[float, Vector, int]] = []
    clock, regime = t_start, int(motion.regimes[0])
    # the stretch of a tangential spring in slip follows from the state, whatever the start has
    begins_as = flow.crossing(values, -1, -1, (regime, regime), state, t_start)
    total[:] = begins_as.after_by_state @ total
    total[:, columns] += begins_as.after_by
    for time, sampled, i in stops:
        legs.append((clock, state, regime))
        clock = time
        state = motion.path[i] if sampled else motion.states[i]
        regime = regime if sampled else int(motion.regimes[i + 1])
    late = np.zeros(total.shape[1])
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
            by_parameters = slopes[leg][:, n : n + len(columns)]
            total[:] = slopes[leg][:, :n] @ total
            total[:, columns] += by_parameters
            if sampled:
                yield time, False, i, late
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
            beyond = crossing.is_beyond(path.ends[leg], system.sizes_in(values))
            # what fires at once is as late as the event before it
            if not (lengths[leg] == 0.0 and beyond):
                late = -along / crossing.speed
            total[:] = crossing.after_by_state @ total + np.outer(crossing.jump, late)
            total[:, columns] += crossing.after_by
            yield time, True, i, late
