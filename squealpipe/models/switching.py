"""Where A1 changes its regime, and into which one: the switching law of A1, its variants and A4.

Friction is set-valued: at ẋ = V any force up to μN may act, so the mass sticks exactly where the
elastic x-force can be held. All functions take plain floats in units of m = k1 = l_pre = 1 and
are compiled into the ensemble's loop as they stand.

Each switch leaves the state one unit of round-off inside its new regime. Without that, an event
function that starts at exactly zero is found again at once: a released mass would stick again
without end, a contact would be lost and found twice.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

from squealpipe.laws.contact import contact_force
from squealpipe.laws.springs import (
    Geometry,
    elastic_force,
    linear_elastic_force,
    linear_stiffness,
)
from squealpipe.models.a1 import Regime


class Event(IntEnum):
    """Kinds of events, as stored in datasets."""

    separation = 0
    contact = 1
    stick = 2
    slip = 3
    reversal = 4


NO_EVENT, CHATTER = -1, -2
SLOWER, FASTER = int(Regime.slip_slower), int(Regime.slip_faster)
STICK, SEPARATED = int(Regime.stick), int(Regime.separated)
SEPARATION, CONTACT = int(Event.separation), int(Event.contact)
TO_STICK, TO_SLIP, REVERSAL = int(Event.stick), int(Event.slip), int(Event.reversal)

EPSILON = 2.0**-52
ABOVE, BELOW = 1.0 + EPSILON, 1.0 - 0.5 * EPSILON
SLACK = 1e-13
"""A located event lies this close to its surface, relative to the terms that cancel there."""
LATE = 1e-9
"""Further than this beyond a surface, an event was missed by the integrator."""


class ScaledParameters(NamedTuple):
    """Physical parameters in units of m = k1 = l_pre = 1, with the attributes of the laws."""

    mass: float
    k1: float
    k2: float
    k3: float
    mu: float
    belt_speed: float
    preload: float
    length1: float
    length2: float


class Rules(NamedTuple):
    """What a variant leaves out (True: the variant has it)."""

    separates: bool
    reverses: bool
    sticks: bool
    linear_springs: bool


class Switch(NamedTuple):
    """A regime change: its kind, the regime after it, and the state's changed parts.

    ``saltation`` multiplies the ẋ component of a tangent vector: the field jumps in ẍ alone and
    the surface is ẋ = V, so the saltation matrix is the identity with ẍ(after)/ẍ(before) there.
    """

    kind: int
    regime: int
    y: float
    vx: float
    saltation: float
    late: bool


VARIANT_RULES: dict[str, Rules] = {
    "A1": Rules(separates=True, reverses=True, sticks=True, linear_springs=False),
    "A1-no-stick": Rules(separates=True, reverses=True, sticks=False, linear_springs=False),
    "A1-no-separation": Rules(separates=False, reverses=True, sticks=True, linear_springs=False),
    "A1-linear-springs": Rules(separates=True, reverses=True, sticks=True, linear_springs=True),
    "A4": Rules(separates=True, reverses=False, sticks=False, linear_springs=True),
}


def spring_forces(
    x: float, y: float, p: ScaledParameters, g: Geometry, linear_springs: bool
) -> tuple[Any, Any]:
    """Force of both springs on the mass, exact or linearized."""
    if linear_springs:
        return linear_elastic_force(x, y, linear_stiffness(p, g))
    return elastic_force(x, y, p, g)


def friction_slack(x: float, y: float, fx: float, p: ScaledParameters) -> float:
    """Round-off of the elastic x-force, from the terms that cancel in it."""
    terms = abs(x) + abs(y) + p.length1 + p.k2 * (abs(x) + abs(y) + p.length2)
    return SLACK * (1.0 + abs(fx) + terms)


def speed_nudge(p: ScaledParameters) -> float:
    """Distance from belt speed at which a released mass starts to slip."""
    return EPSILON * max(1.0, abs(p.belt_speed))


def contact_regime(
    x: float, y: float, vx: float, p: ScaledParameters, g: Geometry, rules: Rules
) -> tuple[int, float]:
    """Regime of a mass that is in contact, and its ẋ moved off V if it slips from there."""
    if not rules.reverses:
        return (SLOWER if p.belt_speed >= 0.0 else FASTER), vx
    if vx < p.belt_speed:
        return SLOWER, vx
    if vx > p.belt_speed:
        return FASTER, vx
    fx, _ = spring_forces(x, y, p, g, rules.linear_springs)
    limit = p.mu * contact_force(y, p)
    if (
        rules.sticks
        and limit > 0.0
        and (fx == 0.0 or abs(fx) < limit - friction_slack(x, y, fx, p))
    ):
        return STICK, vx
    if fx > 0.0:
        return FASTER, p.belt_speed + speed_nudge(p)
    return SLOWER, p.belt_speed - speed_nudge(p)


def start(
    x: float, y: float, vx: float, vy: float, p: ScaledParameters, g: Geometry, rules: Rules
) -> tuple[int, float, float]:
    """Regime at the start, and y and ẋ moved off the switching surfaces if they lie on one."""
    if rules.separates and y >= 1.0:
        _, fy = spring_forces(x, y, p, g, rules.linear_springs)
        if y > 1.0 or vy > 0.0 or (vy == 0.0 and fy > 0.0):
            return SEPARATED, max(y, ABOVE), vx
        y = BELOW
    regime, vx = contact_regime(x, y, vx, p, g, rules)
    return regime, y, vx


def switch(
    x: float,
    y: float,
    vx: float,
    vy: float,
    regime: int,
    step: float,
    p: ScaledParameters,
    g: Geometry,
    rules: Rules,
) -> Switch:
    """The regime change that is due at a state, if any; separation comes before friction.

    Args:
        x, y, vx, vy: the state at the end of an integration step.
        regime: the regime of that step.
        step: its length, which bounds the round-off of the state.
        p, g, rules: parameters, direction cosines and what the variant has.
    """
    if rules.separates:
        reach = SLACK * (1.0 + abs(y) + step * abs(vy))
        if regime == SEPARATED:
            if y <= 1.0 + reach and vy <= 0.0:
                _, fy = spring_forces(x, y, p, g, rules.linear_springs)
                if vy < 0.0 or fy < 0.0:
                    late = y < 1.0 - LATE
                    y = min(y, BELOW)
                    after, vx = contact_regime(x, y, vx, p, g, rules)
                    return Switch(CONTACT, after, y, vx, 1.0, late)
            return Switch(NO_EVENT, regime, y, vx, 1.0, False)
        if y >= 1.0 - reach and vy >= 0.0:
            _, fy = spring_forces(x, y, p, g, rules.linear_springs)
            if vy > 0.0 or fy > 0.0:
                late = y > 1.0 + LATE
                return Switch(SEPARATION, SEPARATED, max(y, ABOVE), vx, 1.0, late)
    if regime == STICK:
        return _release(x, y, vx, p, g, rules)
    if rules.reverses:
        return _reach_belt_speed(x, y, vx, regime, p, g, rules)
    return Switch(NO_EVENT, regime, y, vx, 1.0, False)


def _release(
    x: float, y: float, vx: float, p: ScaledParameters, g: Geometry, rules: Rules
) -> Switch:
    fx, _ = spring_forces(x, y, p, g, rules.linear_springs)
    limit = p.mu * contact_force(y, p)
    slack = friction_slack(x, y, fx, p)
    if abs(fx) < limit - slack or (fx == 0.0 and limit > 0.0):
        return Switch(NO_EVENT, STICK, y, vx, 1.0, False)
    late = abs(fx) > limit + LATE / SLACK * slack
    if fx > 0.0:
        return Switch(TO_SLIP, FASTER, y, p.belt_speed + speed_nudge(p), 1.0, late)
    return Switch(TO_SLIP, SLOWER, y, p.belt_speed - speed_nudge(p), 1.0, late)


def _reach_belt_speed(
    x: float, y: float, vx: float, regime: int, p: ScaledParameters, g: Geometry, rules: Rules
) -> Switch:
    direction = 1.0 if regime == SLOWER else -1.0
    gap = direction * (p.belt_speed - vx)
    scale = 1.0 + abs(p.belt_speed)
    if gap > SLACK * scale:
        return Switch(NO_EVENT, regime, y, vx, 1.0, False)
    fx, _ = spring_forces(x, y, p, g, rules.linear_springs)
    limit = p.mu * contact_force(y, p)
    before = direction * fx + limit
    if before <= 0.0 and gap > -LATE * scale:
        inside = p.belt_speed - direction * max(gap, speed_nudge(p))
        return Switch(NO_EVENT, regime, y, inside, 1.0, False)
    late = gap < -LATE * scale
    if abs(fx) < limit - friction_slack(x, y, fx, p):
        if not rules.sticks:
            return Switch(CHATTER, regime, y, vx, 1.0, late)
        return Switch(TO_STICK, STICK, y, p.belt_speed, 0.0, late)
    after = direction * fx - limit
    saltation = after / before if before != 0.0 else 1.0
    vx = p.belt_speed + direction * max(speed_nudge(p), -gap)
    return Switch(REVERSAL, FASTER if regime == SLOWER else SLOWER, y, vx, saltation, late)


COMPILED = (
    spring_forces,
    friction_slack,
    speed_nudge,
    contact_regime,
    start,
    switch,
    _release,
    _reach_belt_speed,
)
"""Functions that a compiled loop calls, directly or not."""
