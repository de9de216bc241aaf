"""Where A1 changes its regime, and into which one: the switching law of A1, its variants and A4.

Friction is set-valued: at ẋ = V any force up to μN may act, so the mass sticks exactly where the
elastic x-force can be held. All functions take plain floats in units of m = k1 = l_pre = 1 and
are compiled into the ensemble's loop as they stand.

Each switch leaves the state one unit of round-off inside its new regime. Without that, an event
function that starts at exactly zero is found again at once: a released mass would stick again
without end, a contact would be lost and found twice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from squealpipe.codes import Event, Regime
from squealpipe.laws.contact import contact_force
from squealpipe.laws.dashpots import (
    damping_force,
    damping_x_slopes,
    linear_damping,
    linear_damping_force,
)
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.friction_laws import coefficient
from squealpipe.laws.springs import (
    LONG,
    Geometry,
    elastic_force,
    elastic_x_slopes,
    linear_elastic_force,
    linear_stiffness,
)
from squealpipe.parameters import NUMBERS_OF_A1, Parameters

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


NO_KICK = (0.0, 0.0, 0.0, 0.0)


_Numbers: Any = NamedTuple(  # type: ignore[misc]
    "_Numbers", [(name, float) for name in (*NUMBERS_OF_A1, "onset_mu")]
)


class ScaledParameters(_Numbers):  # type: ignore[misc]
    """Physical parameters in units of m = k1 = l_pre = 1, with the attributes of the laws.

    ``static_mu`` limits stick, ``onset_mu`` is the coefficient of slip as its speed goes to 0: all
    that switching knows of a friction law.
    """

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> float: ...

    @classmethod
    def of(cls, params: Parameters) -> ScaledParameters:
        """Those of one run, given in units of m = k1 = l_pre = 1."""
        given = {name: getattr(params, name) for name in NUMBERS_OF_A1}
        given["onset_mu"] = float(coefficient(0.0, params))
        return cls(**given)


class Rules(NamedTuple):
    """What a variant leaves out (True: the variant has it).

    Friction that does not drag is Eq. (4) as printed: both coefficients change their sign, which is
    all that the rules below see of it. Belt speed then repels: it is never held, and a mass exactly
    at it with |x-force of the springs| < μN could leave to either side. It leaves to the side that
    the springs pull to, below belt speed where they do not.
    """

    separates: bool
    reverses: bool
    sticks: bool
    linear_springs: bool
    drags: bool = True


class Switch(NamedTuple):
    """A regime change: its kind, the regime after it, and the state's changed parts.

    The saltation matrix of a tangent vector is the identity but for its ẋ row, because the field
    jumps in ẍ alone: δẋ becomes ``saltation`` δẋ + ``kick`` · (δx, δy, δẋ, δẏ). At belt speed the
    factor is ẍ(after)/ẍ(before); at release with a static coefficient of its own ``kick`` is the
    jump of ẍ times the gradient of the stick margin over its rate.
    """

    kind: int
    regime: int
    y: float
    vx: float
    saltation: float
    late: bool
    kick: tuple[float, float, float, float]


VARIANT_RULES: dict[str, Rules] = {
    "A1": Rules(separates=True, reverses=True, sticks=True, linear_springs=False),
    "A1-no-stick": Rules(separates=True, reverses=True, sticks=False, linear_springs=False),
    "A1-no-separation": Rules(separates=False, reverses=True, sticks=True, linear_springs=False),
    "A1-linear-springs": Rules(separates=True, reverses=True, sticks=True, linear_springs=True),
    "A1-as-printed": Rules(
        separates=True, reverses=True, sticks=False, linear_springs=False, drags=False
    ),
    "A1-as-printed-no-separation": Rules(
        separates=False, reverses=True, sticks=False, linear_springs=False, drags=False
    ),
    "A4": Rules(separates=True, reverses=False, sticks=False, linear_springs=True),
}


def suspension_forces(
    x: float, y: float, vx: float, vy: float, p: ScaledParameters, g: Geometry, linear_springs: bool
) -> tuple[Any, Any]:
    """Force of both springs and dashpots on the mass, exact or linearized."""
    if linear_springs:
        fx, fy = linear_elastic_force(x, y, linear_stiffness(p, g))
        if p.damping1 + p.damping2 > 0.0:
            cx, cy = linear_damping_force(vx, vy, p, g)
            fx, fy = fx + cx, fy + cy
        return fx, fy
    fx, fy = elastic_force(x, y, p, g, p.length1 > LONG, p.length2 > LONG)
    if p.damping1 + p.damping2 > 0.0:
        cx, cy = damping_force(x, y, vx, vy, p, g)
        fx, fy = fx + cx, fy + cy
    return fx, fy


def friction_slack(
    x: float, y: float, vx: float, vy: float, fx: float, p: ScaledParameters
) -> float:
    """Round-off of the stick margin, from the terms that cancel in it.

    The friction limit μs k3 (l_pre − y) is one of them: y is known to a unit of its round-off, so
    with a stiff contact it is the largest.
    """
    reach = abs(x) + abs(y)
    first = reach + (p.length1 if p.length1 <= LONG else 0.0)
    second = reach + (p.length2 if p.length2 <= LONG else 0.0)
    terms = first + p.k2 * second
    terms += (p.damping1 + p.damping2) * (abs(vx) + abs(vy))
    return SLACK * (1.0 + abs(fx) + terms + abs(p.static_mu) * p.k3 * (1.0 + abs(y)))


def speed_nudge(p: ScaledParameters) -> float:
    """Distance from belt speed at which a released mass starts to slip."""
    return EPSILON * max(1.0, abs(p.belt_speed))


def contact_regime(
    x: float, y: float, vx: float, vy: float, p: ScaledParameters, g: Geometry, rules: Rules
) -> tuple[int, float]:
    """Regime of a mass that is in contact, and its ẋ moved off V if it slips from there."""
    if not rules.reverses:
        return (SLOWER if p.belt_speed >= 0.0 else FASTER), vx
    if vx < p.belt_speed:
        return SLOWER, vx
    if vx > p.belt_speed:
        return FASTER, vx
    fx, _ = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
    limit = stick_limit(contact_force(y, p), p)
    if (
        rules.sticks
        and limit > 0.0
        and (fx == 0.0 or abs(fx) < limit - friction_slack(x, y, vx, vy, fx, p))
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
        _, fy = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
        if y > 1.0 or vy > 0.0 or (vy == 0.0 and fy > 0.0):
            return SEPARATED, max(y, ABOVE), vx
        y = BELOW
    regime, vx = contact_regime(x, y, vx, vy, p, g, rules)
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
                _, fy = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
                if vy < 0.0 or fy < 0.0:
                    late = y < 1.0 - LATE
                    y = min(y, BELOW)
                    after, vx = contact_regime(x, y, vx, vy, p, g, rules)
                    return Switch(CONTACT, after, y, vx, 1.0, late, NO_KICK)
            return Switch(NO_EVENT, regime, y, vx, 1.0, False, NO_KICK)
        if y >= 1.0 - reach and vy >= 0.0:
            _, fy = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
            if vy > 0.0 or fy > 0.0:
                late = y > 1.0 + LATE
                return Switch(SEPARATION, SEPARATED, max(y, ABOVE), vx, 1.0, late, NO_KICK)
    if regime == STICK:
        return _release(x, y, vx, vy, p, g, rules)
    if rules.reverses:
        return _reach_belt_speed(x, y, vx, vy, regime, p, g, rules)
    return Switch(NO_EVENT, regime, y, vx, 1.0, False, NO_KICK)


def _release(
    x: float, y: float, vx: float, vy: float, p: ScaledParameters, g: Geometry, rules: Rules
) -> Switch:
    fx, _ = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
    limit = stick_limit(contact_force(y, p), p)
    slack = friction_slack(x, y, vx, vy, fx, p)
    if abs(fx) < limit - slack or (fx == 0.0 and limit > 0.0):
        return Switch(NO_EVENT, STICK, y, vx, 1.0, False, NO_KICK)
    late = abs(fx) > limit + LATE / SLACK * slack
    kick = _release_kick(x, y, vx, vy, fx, p, g, rules)
    if fx > 0.0:
        return Switch(TO_SLIP, FASTER, y, p.belt_speed + speed_nudge(p), 1.0, late, kick)
    return Switch(TO_SLIP, SLOWER, y, p.belt_speed - speed_nudge(p), 1.0, late, kick)


def _release_kick(
    x: float, y: float, vx: float, vy: float, fx: float, p: ScaledParameters, g: Geometry,
    rules: Rules,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Jump of ẍ where stick ends, over the rate of the stick margin, times the margin's gradient.

    Zero where slip begins with the static coefficient, so that the force is continuous.
    """
    if p.static_mu == p.onset_mu:
        return NO_KICK
    side = 1.0 if fx > 0.0 else -1.0
    jump = side * (p.static_mu - p.onset_mu) * contact_force(y, p)
    gx, gy, gvx, gvy = _margin_slopes(x, y, vx, vy, side, p, g, rules)
    _, fy = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
    rate = gx * vx + gy * vy + gvy * (fy + contact_force(y, p))
    if rate == 0.0:
        return NO_KICK
    return jump / rate * gx, jump / rate * gy, jump / rate * gvx, jump / rate * gvy


def _margin_slopes(
    x: float, y: float, vx: float, vy: float, side: float, p: ScaledParameters, g: Geometry,
    rules: Rules,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Gradient of the stick margin μs N − |x-force of springs and dashpots|."""
    if rules.linear_springs:
        k11, k12, _ = linear_stiffness(p, g)
        c11, c12, _ = linear_damping(p, g)
        return side * k11, side * k12 - p.static_mu * p.k3, side * c11, side * c12
    kx, ky = elastic_x_slopes(x, y, p, g)
    cx, cy, cvx, cvy = damping_x_slopes(x, y, vx, vy, p, g)
    return -side * (kx + cx), -side * (ky + cy) - p.static_mu * p.k3, -side * cvx, -side * cvy


def _reach_belt_speed(
    x: float, y: float, vx: float, vy: float, regime: int, p: ScaledParameters, g: Geometry,
    rules: Rules,
) -> Switch:  # fmt: skip
    direction = 1.0 if regime == SLOWER else -1.0
    gap = direction * (p.belt_speed - vx)
    scale = 1.0 + abs(p.belt_speed)
    if gap > SLACK * scale:
        return Switch(NO_EVENT, regime, y, vx, 1.0, False, NO_KICK)
    fx, _ = suspension_forces(x, y, vx, vy, p, g, rules.linear_springs)
    normal = contact_force(y, p)
    limit = p.onset_mu * normal
    before = direction * fx + limit
    if before <= 0.0 and gap > -LATE * scale:
        inside = p.belt_speed - direction * max(gap, speed_nudge(p))
        return Switch(NO_EVENT, regime, y, inside, 1.0, False, NO_KICK)
    late = gap < -LATE * scale
    hold = stick_limit(normal, p) if rules.sticks else limit
    if abs(fx) < hold - friction_slack(x, y, vx, vy, fx, p):
        if not rules.sticks:
            return Switch(CHATTER, regime, y, vx, 1.0, late, NO_KICK)
        return Switch(TO_STICK, STICK, y, p.belt_speed, 0.0, late, NO_KICK)
    after = direction * fx - limit
    saltation = after / before if before != 0.0 else 1.0
    vx = p.belt_speed + direction * max(speed_nudge(p), -gap)
    return Switch(REVERSAL, FASTER if regime == SLOWER else SLOWER, y, vx, saltation, late, NO_KICK)


COMPILED = (
    suspension_forces,
    friction_slack,
    speed_nudge,
    contact_regime,
    start,
    switch,
    _release,
    _release_kick,
    _margin_slopes,
    _reach_belt_speed,
)
"""Functions that a compiled loop calls, directly or not."""
