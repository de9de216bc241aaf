"""Event-driven integration of a hybrid system by scipy's ``solve_ivp``: a public method.

A hybrid system has a smooth field in each of a few regimes, guards whose sign change ends a
regime, and a rule that names the next regime. This is how such systems are commonly integrated;
it is here to be compared with. Its known weakness is scipy's: guards are looked at only at the
ends of steps, so a pair of crossings inside one step is passed over without a word.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

Field = Callable[[float, np.ndarray], Sequence[float]]

IMPLICIT = ("Radau", "BDF", "LSODA")
"""Methods of ``solve_ivp`` that also evaluate the field to form Jacobians."""


class Guard(NamedTuple):
    """A function of the state that ends a regime when it crosses zero.

    Attributes:
        kind: what the crossing means, an integer of the caller's.
        value: the function of the state.
        direction: −1 where falling through zero counts, +1 where rising does.
    """

    kind: int
    value: Callable[[np.ndarray], float]
    direction: int


@dataclass(frozen=True)
class HybridAutomaton:
    """A system of several regimes.

    Attributes:
        fields: regime → field f(t, z) of that regime.
        guards: regime → guards that end it.
        start: state → regime at the start.
        switch: (kind of the event, regime, state) → (next regime, state put onto the guard).
    """

    fields: Callable[[int], Field]
    guards: Callable[[int], Sequence[Guard]]
    start: Callable[[np.ndarray], int]
    switch: Callable[[int, int, np.ndarray], tuple[int, np.ndarray]]


@dataclass
class HybridRun:
    """What an event-driven run gave.

    Attributes:
        state: at the end.
        time: reached; less than asked where it failed.
        event_times, event_kinds: in order.
        regimes: the regime at the start and after each event.
        samples: states at the asked times, shape (times, states); NaN beyond the time reached.
        evaluations: of the field, those for Jacobians by differences included.
        message: empty where it ran to the end.
        reports_events: whether the method knows of events at all.
    """

    state: np.ndarray
    time: float = 0.0
    event_times: list[float] = field(default_factory=list)
    event_kinds: list[int] = field(default_factory=list)
    regimes: list[int] = field(default_factory=list)
    samples: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    evaluations: int = 0
    message: str = ""
    reports_events: bool = True


def integrate_hybrid(
    system, initial_state, t_end, *, method, tol, times=(), stop_at=None, max_events=10_000
):
    """Integrate from 0 to ``t_end``, restarting ``solve_ivp`` at each event.

    Args:
        system: the hybrid system.
        initial_state: state at t = 0.
        t_end: end of the run.
        method: any of ``solve_ivp``.
        tol: relative and absolute tolerance.
        times: ascending instants at which the interpolated state is wanted.
        stop_at: kind of event at which to stop.
        max_events: events after which the run is given up, with a message.
    """
    state = np.asarray(initial_state, dtype=float)
    times = np.asarray(times, dtype=float)
    regime = system.start(state)
    run = HybridRun(state, regimes=[regime], samples=np.full((len(times), len(state)), np.nan))
    while run.time < t_end:
        guards = system.guards(regime)
        wanted = np.flatnonzero((times >= run.time) & (times <= t_end))
        solution = solve_ivp(
            system.fields(regime), (run.time, t_end), run.state, method=method,
            rtol=max(tol, 100 * np.finfo(float).eps), atol=tol,
            events=[_terminal(guard) for guard in guards], dense_output=len(wanted) > 0,
        )  # fmt: skip
        run.evaluations += solution.nfev
        if method in IMPLICIT:
            run.evaluations += len(state) * solution.njev
        reached = float(solution.t[-1])
        if len(wanted):
            inside = wanted[times[wanted] <= reached]
            if len(inside):
                run.samples[inside] = solution.sol(times[inside]).T
        run.time, run.state = reached, solution.y[:, -1]
        if solution.status < 0:
            run.message = solution.message
            break
        if solution.status == 0:
            break
        hit = next(i for i, found in enumerate(solution.t_events) if len(found))
        run.event_times.append(reached)
        run.event_kinds.append(guards[hit].kind)
        regime, run.state = system.switch(guards[hit].kind, regime, run.state)
        run.regimes.append(regime)
        if guards[hit].kind == stop_at:
            break
        if len(run.event_times) >= max_events:
            run.message = f"{max_events} events by t = {reached:.6g}"
            break
    return run


def _terminal(guard):
    def event(_, state):
        return guard.value(state)

    event.terminal = True
    event.direction = guard.direction
    return event
