"""A1 in long double: what every other integration of A1 is judged by."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import SimpleNamespace
from typing import Any

import heyoka
import numpy as np

from squealpipe.laws.contact import contact_force
from squealpipe.laws.springs import Geometry
from squealpipe.methods.hybrid import HybridRun
from squealpipe.methods.long_double import ROUND_OFF, compile_long_double, integrate_long_double
from squealpipe.models.a1 import Regime, acceleration, spring_force
from squealpipe.models.a1_automaton import A1Automaton, EventKind
from squealpipe.parameters import Parameters

_PHYSICAL = ("mass", "k1", "k2", "k3", "mu", "belt_speed", "preload", "length1", "length2")
_REGIME = ("contact", "direction", "stick", "slips")
_SURFACES = (EventKind.separation, EventKind.belt_speed, EventKind.release, EventKind.release)


@cache
def _integrator() -> Any:
    x, y, vx, vy = heyoka.make_vars("x", "y", "vx", "vy")
    names = (*_PHYSICAL, *Geometry._fields, *_REGIME)
    value = {name: heyoka.par[index] for index, name in enumerate(names)}
    p = SimpleNamespace(**value)
    g = Geometry(p.c1, p.s1, p.c2, p.s2)
    ax, ay = acceleration(x, y, p, g, contact=p.contact, direction=p.direction, stick=p.stick)
    pull, _ = spring_force(x, y, p, g, linear_springs=False)
    grip = p.mu * contact_force(y, p)
    # where a regime does not watch a surface, the surface is the constant 1
    return compile_long_double(
        [(x, vx), (y, vy), (vx, ax), (vy, ay)],
        [
            p.preload - y,
            p.slips * (p.belt_speed - vx) + (1.0 - p.slips),
            p.stick * (grip - pull) + (1.0 - p.stick),
            p.stick * (grip + pull) + (1.0 - p.stick),
        ],
    )


def simulate_reference(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    *,
    t_end: float,
    initial_state: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
    stop_at: int | None = None,
) -> HybridRun:
    """A1 by :mod:`squealpipe.methods.long_double`; errors about 1e-17 outside chaos.

    Args:
        params: physical parameters; alpha1, alpha2: angles, rad.
        t_end: horizon, s.
        initial_state: (x, y, ẋ, ẏ) at t = 0.
        stop_at: an :class:`squealpipe.models.a1_automaton.EventKind` to stop at.
    """
    a1 = A1Automaton(params, alpha1, alpha2)
    physical = [getattr(params, name) for name in _PHYSICAL]

    def parameters(regime: int) -> list[float]:
        contact = float(regime != Regime.separated)
        stick = float(regime == Regime.stick)
        direction = {Regime.slip_slower: 1.0, Regime.slip_faster: -1.0}.get(Regime(regime), 0.0)
        return [*physical, *a1.geometry, contact, direction, stick, direction * direction]

    def switch(surface: int, regime: int, z: np.ndarray) -> tuple[int, int, np.ndarray]:
        kind = _SURFACES[surface]
        if kind == EventKind.separation and regime == Regime.separated:
            kind = EventKind.contact
        after, z = a1.switch(kind, regime, z)
        return kind, after, a1.leave(after, z, ROUND_OFF)

    state = np.asarray(initial_state, dtype=np.longdouble)
    regime = a1.start(state)
    if regime == Regime.stick:
        state[2] = params.belt_speed
    return integrate_long_double(
        _integrator(), parameters, (regime, a1.leave(regime, state, ROUND_OFF)), switch, t_end,
        stop_at=stop_at,
    )  # fmt: skip
