"""A1 by public methods: scipy with events, tanh-regularized, and Moreau–Jean time stepping."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from squealpipe.laws.springs import Geometry, geometry
from squealpipe.methods.hybrid import Guard, HybridAutomaton, HybridRun, integrate_hybrid
from squealpipe.methods.time_stepping import jitted, step_through
from squealpipe.models.a1_automaton import (
    A1Automaton,
    EventKind,
    PlainParameters,
    regularized_field,
    smooth_forces,
)
from squealpipe.models.refusals import refuse_extensions
from squealpipe.parameters import Parameters

AT_REST = (0.0, 0.0, 0.0, 0.0)


def simulate_scipy(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    t_end: float,
    method: str = "DOP853",
    tol: float = 1e-10,
    times: Sequence[float] | np.ndarray = (),
    initial_state: Sequence[float] = AT_REST,
    stop_at: int | None = None,
    stick: bool = True,
    linear_springs: bool = False,
) -> HybridRun:
    """A1 by scipy's ``solve_ivp`` with terminal events, restarted at each.

    Args:
        params: physical parameters; alpha1, alpha2: angles, rad.
        t_end: horizon, s.
        method: RK45, DOP853, LSODA, Radau or BDF.
        tol: relative and absolute tolerance.
        times: instants at which the state is wanted (``samples`` of the result).
        initial_state: (x, y, ẋ, ẏ) at t = 0.
        stop_at: an :class:`squealpipe.models.a1_automaton.EventKind` to stop at.
        stick, linear_springs: the variants of A1.
    """
    a1 = A1Automaton(params, alpha1, alpha2, stick=stick, linear_springs=linear_springs)

    def switch(kind: int, regime: int, z: np.ndarray) -> tuple[int, np.ndarray]:
        after, z = a1.switch(kind, regime, z)
        return after, a1.leave(after, z, float(np.finfo(float).eps))

    system = HybridAutomaton(
        a1.field, lambda regime: [Guard(*guard) for guard in a1.guards(regime)], a1.start, switch
    )
    return integrate_hybrid(
        system, initial_state, t_end, method=method, tol=tol, times=times, stop_at=stop_at
    )


def simulate_regularized(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    t_end: float,
    sigma: float,
    method: str = "LSODA",
    tol: float = 1e-8,
    initial_state: Sequence[float] = AT_REST,
) -> HybridRun:
    """A1 without events: contact tanh σ(l_pre − y), friction tanh σ(V − ẋ)/ω0, ω0 = √(k1/m).

    Args:
        sigma: 1/m; the friction's width in velocity is ω0/σ.
        method, tol: of ``solve_ivp``.
    """
    field = regularized_field(params, alpha1, alpha2, sigma, sigma * params.time_unit)
    system = HybridAutomaton(
        lambda _: field, lambda _: [], lambda _: 0, lambda _, regime, z: (regime, z)
    )
    run = integrate_hybrid(system, initial_state, t_end, method=method, tol=tol)
    run.reports_events = False
    return run


def simulate_moreau_jean(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    t_end: float,
    step: float,
    initial_state: Sequence[float] = AT_REST,
    stop_at_switch: bool = False,
) -> HybridRun:
    """A1 by Moreau–Jean time stepping; ``event_kinds`` only counts contact changes.

    Args:
        step: s; shortened so that a whole number of steps ends at ``t_end``.
        stop_at_switch: end at the first contact change.
    """
    refuse_extensions(params, "Moreau–Jean time stepping", "its smooth forces depend on position")
    n_steps = max(1, math.ceil(t_end / step - 1e-9))
    state = np.array(initial_state, dtype=float)
    data = (
        PlainParameters(**params.as_dict()),
        Geometry(*map(float, geometry(alpha1, alpha2))),
    )
    switches, made = step_through(
        jitted(smooth_forces), data, params.mass, params.belt_speed, state, t_end / n_steps,
        n_steps, stop_at_switch,
    )  # fmt: skip
    message = "" if np.isfinite(state).all() else "the state overflowed"
    return HybridRun(
        state,
        time=made * t_end / n_steps,
        event_kinds=[int(EventKind.separation)] * switches,
        evaluations=made,
        message=message,
    )
