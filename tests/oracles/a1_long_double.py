"""A1 in 80-bit long double, by which every other integration of A1 is judged.

heyoka's Taylor series at a tolerance near 1e-19, whose events are watched by the whole polynomial
of each step, so that no pair of crossings is passed over. Errors are about 1e-17 outside chaos.
"""

from functools import cache
from types import SimpleNamespace

import heyoka
import numpy as np

from squealpipe.brake.models.a1 import State, acceleration, suspension_force
from squealpipe.codes import Regime
from squealpipe.laws.contact import contact_force
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.springs import Geometry
from squealpipe.parameters import NUMBERS_OF_A1
from squealpipe.systems.natural_exponential import exp
from tests.oracles.a1_automaton import DIRECTION, A1Automaton, EventKind, HybridRun

exp.register(heyoka.expression, heyoka.exp)
heyoka.set_logger_level_error()
heyoka.llvm_state.set_diskcache_enabled(False)  # no file outside the project

PARAMETERS = (
    *NUMBERS_OF_A1,
    *Geometry._fields,
    "contact",
    "direction",
    "stick",
    "slips",
)
"""Names of the symbolic parameters, in order; the last four are those of a regime."""
SURFACES = (
    EventKind.separation,
    EventKind.belt_speed,
    EventKind.release,
    EventKind.release,
)
ULP = 2.0**-62
"""A state on a surface is moved by this (times its scale), so that its root is not found again."""
MOST_EVENTS = 100_000


@cache
def _integrator(law):
    """A1's equations as heyoka expressions, stopping at the roots of the surfaces."""
    x, y, vx, vy = heyoka.make_vars("x", "y", "vx", "vy")
    value = {name: heyoka.par[index] for index, name in enumerate(PARAMETERS)}
    p = SimpleNamespace(friction_law=law, contact_law=LINEAR, **value)
    g = Geometry(p.c1, p.s1, p.c2, p.s2)
    regime = {"contact": p.contact, "direction": p.direction, "stick": p.stick}
    state = State(x, y, vx, vy)
    ax, ay = acceleration(state, p, g, **regime)
    pull, _ = suspension_force(state, p, g)
    grip = stick_limit(contact_force(y, p), p)
    surfaces = [  # where a regime does not watch a surface, the surface is the constant 1
        p.preload - y,
        p.slips * (p.belt_speed - vx) + (1.0 - p.slips),
        p.stick * (grip - pull) + (1.0 - p.stick),
        p.stick * (grip + pull) + (1.0 - p.stick),
    ]
    long = {"fp_type": np.longdouble}
    return heyoka.taylor_adaptive(
        [(x, vx), (y, vy), (vx, ax), (vy, ay)],
        np.zeros(4, np.longdouble),
        **long,
        tol=np.longdouble(1e-19),
        compact_mode=True,  # compiles in a tenth of the time
        t_events=[
            heyoka.t_event(each, cooldown=np.longdouble(0), **long) for each in surfaces
        ],
    )


def simulate_reference(
    params, alpha1, alpha2, *, t_end, initial_state=(0.0, 0.0, 0.0, 0.0)
):
    """A1 from (x, y, ẋ, ẏ) at t = 0 to the horizon, s, through all events."""
    a1, integrator = (
        A1Automaton(params, alpha1, alpha2),
        _integrator(params.friction_law),
    )
    numbers = [getattr(params, name) for name in NUMBERS_OF_A1]
    state = np.array(initial_state, dtype=np.longdouble)
    regime = a1.start(state)
    if regime == Regime.stick:
        state[2] = params.belt_speed
    run = HybridRun(a1.leave(regime, state, ULP), regimes=[regime])
    integrator.time, last = np.longdouble(0), np.longdouble(t_end)
    while run.time < last:
        direction = DIRECTION.get(regime, 0.0)
        of_regime = (
            regime != Regime.separated,
            direction,
            regime == Regime.stick,
            direction**2,
        )
        integrator.pars[:] = np.array(
            [*numbers, *a1.geometry, *of_regime], np.longdouble
        )
        integrator.state[:] = run.state
        integrator.reset_cooldowns()
        outcome = integrator.propagate_until(last)[0]
        run.time, run.state = integrator.time, integrator.state.copy()
        if outcome == heyoka.taylor_outcome.time_limit:
            break
        surface = -outcome.value - 1
        if surface < 0 or len(run.event_times) >= MOST_EVENTS:
            run.message = (
                f"{outcome} after {len(run.event_times)} events at t = {run.time}"
            )
            break
        kind = SURFACES[surface]
        if kind == EventKind.separation and regime == Regime.separated:
            kind = EventKind.contact
        regime, state = a1.switch(kind, run.state)
        run.state = a1.leave(regime, state, ULP)
        run.add(kind, regime)
    return run


def derivative_along(
    params, alpha1, alpha2, direction, *, t_end, initial_state, step=1e-9
):
    """Of the final state, by a central difference; None where the two runs differ in events."""
    shift = np.longdouble(step) * np.asarray(direction, np.longdouble)
    low, high = (
        simulate_reference(
            params, alpha1, alpha2, t_end=t_end, initial_state=initial_state + each
        )
        for each in (-shift, shift)
    )
    same = low.regimes == high.regimes
    return (high.state - low.state).astype(float) / (2 * step) if same else None
