"""A reference: Taylor series of high order in 80-bit long double, with located events.

heyoka's scalar integrator at a tolerance near 1e-19. Event functions are watched by the whole
Taylor polynomial of each step, so no pair of crossings is passed over. Slow, and meant to judge
the others by: its error is thousands of times below that of any double-precision method.
"""

import heyoka
import numpy as np

from tests.oracles import taylor_compiler
from tests.oracles.a1_automaton import HybridRun

TOLERANCE = 1e-19
LONG_ULP = 2.0**-62
"""A state on a surface is moved by this (times its scale), so that its root is not found again."""


def compile_long_double(equations, surfaces):
    """heyoka's integrator in long double, stopping at the roots of the surfaces."""
    taylor_compiler.set_up()
    return heyoka.taylor_adaptive(
        list(equations),
        np.zeros(len(equations), dtype=np.longdouble),
        fp_type=np.longdouble,
        tol=np.longdouble(TOLERANCE),
        t_events=[
            heyoka.t_event(surface, fp_type=np.longdouble, cooldown=np.longdouble(0))
            for surface in surfaces
        ],
    )


def integrate_long_double(integrator, parameters, start, switch, t_end, *, max_events=100_000):
    """Integrate from 0 to ``t_end`` through all events.

    Args:
        integrator: of :func:`compile_long_double`.
        parameters: regime → values of the symbolic parameters.
        start: the regime and the state at the start.
        switch: (surface, regime, state) → (kind, next regime, state off the surface).
        t_end: end of the run.
        max_events: events after which the run is given up, with a message.
    """
    regime, state = start
    integrator.time = np.longdouble(0)
    run = HybridRun(state, regimes=[regime])
    last = np.longdouble(t_end)
    while run.time < last:
        integrator.pars[:] = np.asarray(parameters(regime), dtype=np.longdouble)
        integrator.state[:] = run.state
        integrator.reset_cooldowns()
        outcome = integrator.propagate_until(last)[0]
        run.time, run.state = integrator.time, integrator.state.copy()
        if outcome == heyoka.taylor_outcome.time_limit:
            break
        surface = -outcome.value - 1
        if surface < 0 or len(run.event_times) >= max_events:
            run.message = f"{outcome} after {len(run.event_times)} events at t = {run.time}"
            break
        kind, regime, run.state = switch(surface, regime, run.state)
        run.event_times.append(run.time)
        run.event_kinds.append(kind)
        run.regimes.append(regime)
    return run
