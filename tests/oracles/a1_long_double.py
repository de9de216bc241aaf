"""A1 in long double: what every other integration of A1 is judged by."""

from functools import cache, partial
from types import SimpleNamespace

import heyoka
import numpy as np

from squealpipe.codes import Regime
from squealpipe.laws.contact import contact_force
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.springs import Geometry
from squealpipe.models.a1 import acceleration, suspension_force
from squealpipe.parameters import NUMBERS_OF_A1
from tests.oracles.a1_automaton import A1Automaton, EventKind
from tests.oracles.long_double import LONG_ULP, compile_long_double, integrate_long_double

_REGIME = ("contact", "direction", "stick", "slips")
PARAMETERS = (*NUMBERS_OF_A1, *Geometry._fields, *_REGIME)
"""Names of the symbolic parameters, in order."""
VARIED = len(NUMBERS_OF_A1) + len(Geometry._fields)
"""How many of them belong to the system, not to a regime."""
SURFACES = (EventKind.separation, EventKind.belt_speed, EventKind.release, EventKind.release)


def symbolic_automaton(law):
    """Equations and surfaces of A1 as heyoka expressions; :func:`regime_values` fills them."""
    x, y, vx, vy = heyoka.make_vars("x", "y", "vx", "vy")
    value = {name: heyoka.par[index] for index, name in enumerate(PARAMETERS)}
    p = SimpleNamespace(friction_law=law, contact_law=LINEAR, **value)
    g = Geometry(p.c1, p.s1, p.c2, p.s2)
    ax, ay = acceleration(
        x, y, vx, vy, p, g, contact=p.contact, direction=p.direction, stick=p.stick
    )
    pull, _ = suspension_force(x, y, vx, vy, p, g, linear_springs=False)
    grip = stick_limit(contact_force(y, p), p)
    # where a regime does not watch a surface, the surface is the constant 1
    surfaces = [
        p.preload - y,
        p.slips * (p.belt_speed - vx) + (1.0 - p.slips),
        p.stick * (grip - pull) + (1.0 - p.stick),
        p.stick * (grip + pull) + (1.0 - p.stick),
    ]
    return [(x, vx), (y, vy), (vx, ax), (vy, ay)], surfaces


def regime_values(a1, regime):
    """Values of the symbolic parameters in a regime."""
    physical = [getattr(a1.params, name) for name in NUMBERS_OF_A1]
    contact = float(regime != Regime.separated)
    stick = float(regime == Regime.stick)
    direction = {Regime.slip_slower: 1.0, Regime.slip_faster: -1.0}.get(Regime(regime), 0.0)
    return [*physical, *a1.geometry, contact, direction, stick, direction * direction]


@cache
def _integrator(law):
    return compile_long_double(*symbolic_automaton(law))


def simulate_reference(params, alpha1, alpha2, *, t_end, initial_state=(0.0, 0.0, 0.0, 0.0)):
    """A1 by :mod:`tests.oracles.long_double`; errors about 1e-17 outside chaos.

    Args:
        params: physical parameters; alpha1, alpha2: angles, rad.
        t_end: horizon, s.
        initial_state: (x, y, ẋ, ẏ) at t = 0.
    """
    a1 = A1Automaton(params, alpha1, alpha2)

    def switch(surface, regime, z):
        kind = SURFACES[surface]
        if kind == EventKind.separation and regime == Regime.separated:
            kind = EventKind.contact
        after, z = a1.switch(kind, z)
        return kind, after, a1.leave(after, z, LONG_ULP)

    state = np.asarray(initial_state, dtype=np.longdouble)
    regime = a1.start(state)
    if regime == Regime.stick:
        state[2] = params.belt_speed
    return integrate_long_double(
        _integrator(params.friction_law), partial(regime_values, a1),
        (regime, a1.leave(regime, state, LONG_ULP)), switch, t_end,
    )  # fmt: skip
