"""A1 by scipy with located events: an independent judge of our own runs."""

import numpy as np

from tests.oracles.a1_automaton import A1Automaton
from tests.oracles.hybrid import Guard, HybridAutomaton, integrate_hybrid

AT_REST = (0.0, 0.0, 0.0, 0.0)


def simulate_scipy(
    params,
    alpha1,
    alpha2,
    *,
    t_end,
    method="DOP853",
    tol=1e-10,
    times=(),
    initial_state=AT_REST,
    stop_at=None,
    stick=True,
    linear_springs=False,
):
    """A1 by scipy's ``solve_ivp`` with terminal events, restarted at each.

    Args:
        params: physical parameters; alpha1, alpha2: angles, rad.
        t_end: horizon, s.
        method: RK45, DOP853, LSODA, Radau or BDF.
        tol: relative and absolute tolerance.
        times: instants at which the state is wanted (``samples`` of the result).
        initial_state: (x, y, ẋ, ẏ) at t = 0.
        stop_at: an :class:`tests.oracles.a1_automaton.EventKind` to stop at.
        stick, linear_springs: the variants of A1.
    """
    a1 = A1Automaton(params, alpha1, alpha2, stick=stick, linear_springs=linear_springs)

    def switch(kind, regime, z):
        after, z = a1.switch(kind, regime, z)
        return after, a1.leave(after, z, float(np.finfo(float).eps))

    system = HybridAutomaton(
        a1.field, lambda regime: [Guard(*guard) for guard in a1.guards(regime)], a1.start, switch
    )
    return integrate_hybrid(
        system, initial_state, t_end, method=method, tol=tol, times=times, stop_at=stop_at
    )
