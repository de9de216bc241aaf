"""A1 by scipy with located events: an independent judge of our own runs.

A public method, restarted at each event. Its known weakness is scipy's: guards are looked at only
at the ends of steps, so a pair of crossings inside one step is passed over without a word.
"""

import numpy as np
from scipy.integrate import solve_ivp

from tests.oracles.a1_automaton import A1Automaton, HybridRun

EPS = float(np.finfo(float).eps)


def simulate_scipy(
    params, *angles, t_end, tol=1e-10, initial_state=(0, 0, 0, 0), **options
):
    """A1 from (x, y, ẋ, ẏ) by scipy's DOP853 with terminal events, to a tolerance."""
    a1 = A1Automaton(params, *angles, **options)
    state = np.asarray(initial_state, dtype=float)
    regime = a1.start(state)
    run = HybridRun(state, regimes=[regime])
    while run.time < t_end:
        guards = a1.guards(regime)
        solution = solve_ivp(
            a1.field(regime),
            (run.time, t_end),
            run.state,
            method="DOP853",
            rtol=max(tol, 100 * EPS),
            atol=tol,
            events=[_terminal(value, direction) for _, value, direction in guards],
        )
        run.time, run.state = float(solution.t[-1]), solution.y[:, -1]
        run.message = "" if solution.status >= 0 else solution.message
        if solution.status < 1:
            break
        kind = guards[
            next(i for i, found in enumerate(solution.t_events) if len(found))
        ][0]
        regime, state = a1.switch(kind, run.state)
        run.state = a1.leave(regime, state, EPS)
        run.add(kind, regime)
    return run


def _terminal(value, direction):
    def event(_, state):
        return value(state)

    event.terminal, event.direction = True, direction
    return event
