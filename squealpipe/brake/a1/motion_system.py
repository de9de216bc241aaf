"""Make the brake pad of A1 a system: exact springs and dashpots, contact loss, friction with stick.

Idea: forces are written once, as functions of state, parameters and constants of the regime; slip
either way, stick and separation differ by these constants alone. Two pads whose laws differ by
constants share one trace and its machine code. Invariant: within a regime the field is smooth,
since a table of friction or contact is regimes whose knots are switches.

``brake(law)`` is the system for one friction law, one contact law and one of A1's variants or A4.
Its parameters are those of ``Parameters`` and both angles; the laws are those of
:mod:`squealpipe.laws`.
"""

from collections.abc import Iterable, Iterator
from functools import cache
from types import SimpleNamespace
from typing import Any

from squealpipe.brake.models import a1
from squealpipe.brake.models.variants import VARIANT_RULES, Rules
from squealpipe.codes import Regime
from squealpipe.laws import contact_laws, friction_laws
from squealpipe.laws.contact import normal_force
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.friction_laws import COULOMB
from squealpipe.laws.springs import LONG_SPRING, Geometry, fixed_ends
from squealpipe.laws.tables import is_table, pieces_of
from squealpipe.parameters import NUMBERS_OF_A1, TABLE, Parameters
from squealpipe.systems.belt_contact import (
    DECIDES_FIRST,
    BeltContact,
    Surface,
    knots,
    negative,
)
from squealpipe.systems.components import Switch
from squealpipe.systems.functions import cos, sin
from squealpipe.systems.system import System
from squealpipe.systems.tracing import TracedSystem


def brake_of(
    params: Parameters, model: str = "A1", varied: Iterable[str] = ()
) -> System:
    """A1, or a variant, with some parameters, whose numbers ``parameters_of_run`` gives.

    Args:
        varied: parameters whose numbers will change. A static coefficient that is none of its own
            then follows the law's numbers.
    """
    law, varied = params.friction_law, {*varied}
    one_mu = law in friction_laws.LAWS and params.static_mu == params.mu
    if varied:
        one_mu = params.mu_static is None and not is_table(law)
    falls = law in friction_laws.FALLING
    varies_length = bool(varied & {"preload", "length1", "length2"})
    return brake(
        COULOMB if one_mu and falls else law,
        damped=params.damping1 + params.damping2 > 0
        or bool(varied & {"damping1", "damping2"}),
        contact_law=contact_laws.relative(params.contact_law, params.preload),
        model=model,
        one_mu=one_mu,
        long_springs=(
            not varies_length and params.length1 > LONG_SPRING * params.preload,
            not varies_length and params.length2 > LONG_SPRING * params.preload,
        ),
    )


def has_own_laws(params: Any) -> bool:
    """Return whether a law is none of the formulas that A1's own loop has."""
    return isinstance(params, Parameters) and not (
        params.friction_law in friction_laws.LAWS and params.contact_law == LINEAR
    )


def regimes_of(system: TracedSystem) -> list[Regime]:
    """A1's regime of each regime of the system, which may have several of a kind."""
    return [
        next((r for r in Regime if name.startswith(r.name)), Regime.separated)
        for name in system.regimes
    ]


def parameters_of_run(
    params: Parameters, alpha1: float, alpha2: float
) -> dict[str, float]:
    """Return the parameters of a run of :func:`brake`."""
    numbers = {name: getattr(params, name) for name in NUMBERS_OF_A1}
    return {**numbers, "alpha1": alpha1, "alpha2": alpha2}


@cache
def brake(  # noqa: C901 (one short function for each force and surface)
    friction_law: str = COULOMB,
    *,
    damped: bool = False,
    contact_law: str = LINEAR,
    model: str = "A1",
    one_mu: bool = False,
    long_springs: tuple[bool, bool] = (False, False),
) -> System:
    """A1, or a variant of it, with one friction law and one contact law.

    Args:
        friction_law: its name, or a table.
        damped: with dashpots; without, ``damping1`` and ``damping2`` are not read.
        contact_law: its name, or a table over l_pre and the force there.
        model: a key of ``VARIANT_RULES``. Without stick, a run ends where the mass would stick, as
            an accumulation of events.
        one_mu: what holds the mass is the law's coefficient at speed 0, which changes with the
            numbers that the law reads; ``static_mu`` is not read.
        long_springs: which springs are longer than ``springs.LONG`` preload lengths.
    """
    rules = VARIANT_RULES[model]
    laws = _Laws(friction_law, contact_law, rules, one_mu=one_mu)
    default = Parameters(friction_law=friction_law, contact_law=contact_law)
    defaults = {name: getattr(default, name) for name in NUMBERS_OF_A1}
    defaults |= {"alpha1": 1.0, "alpha2": 1.0}
    traced = (laws.form, damped, model, one_mu, long_springs)
    if traced in _forms:
        return _forms[traced].with_numbers(laws.belt.regimes(), defaults)
    form = a1.Suspension(rules.linear_springs, long_springs, damped)

    def suspension(s: Any, p: Any, r: Any) -> tuple[Any, Any]:
        return a1.suspension_force(s, *laws.of(p, r), form)

    def pull(s: Any, p: Any, r: Any) -> Any:
        return suspension(s, p, r)[0]

    def rises(t: Any, s: Any, p: Any, r: Any) -> Any:
        return DECIDES_FIRST * s.vy + suspension(s, p, r)[1]

    def force(t: Any, s: Any, p: Any, r: Any) -> Any:
        return r.contact * normal_force(s.y, s.vy, laws.of(p, r)[0])

    def limit(s: Any, p: Any, r: Any) -> Any:
        q, _ = laws.of(p, r)
        return stick_limit(normal_force(s.y, s.vy, q), q)

    def field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        ax, ay = a1.acceleration(
            s,
            *laws.of(p, r),
            contact=r.contact,
            direction=r.direction,
            stick=r.stick,
            form=form,
        )
        return {"x": s.vx, "y": s.vy, "vx": ax, "vy": ay}

    # Relative to k1 l_pre: round-off of the force balance at rest. Without it a mass at rest that
    # nothing pulls and no friction holds, as where N = 0 or μ = 0, would slide. Squared, it is no
    # slack beside a limit that is not nearly 0: exactly there round-off decides.
    stick_tolerance = 1e-14

    def holds(t: Any, s: Any, p: Any, r: Any) -> Any:
        """The condition of stick: |elastic x-force and dashpots| ≤ μs N, within round-off."""
        slack = stick_tolerance * p.k1 * p.preload
        return limit(s, p, r) ** 2 + slack**2 - pull(s, p, r) ** 2

    # Squared distance from a pivot, in free lengths, below which the spring's direction is lost
    # to round-off
    pivot_reach_squared = 1e-14

    def pivot(spring: int) -> Any:
        def distance2(t: Any, s: Any, p: Any, r: Any) -> Any:
            ends = fixed_ends(*laws.of(p, r))
            x, y = s.x - ends[2 * spring], s.y - ends[2 * spring + 1]
            return (x * x + y * y) * (
                (p.length1, p.length2)[spring]
            ) ** -2.0 - pivot_reach_squared

        return distance2

    def free(t: Any, s: Any, p: Any, r: Any) -> Any:
        return s.y - p.preload

    def scales(p: Any) -> dict[str, Any]:
        # of a stiffness without round-off: that of the first spring is 1
        return {
            "kg": p.mass,
            "m": p.preload,
            "s": (p.mass / p.k1) ** 0.5,
            "N": p.k1 * p.preload,
            "N m-1": p.k1,
        }

    states = {"x": "m", "y": "m", "vx": "m/s", "vy": "m/s"}
    reach = ("m2", lambda t, s, p, r: s.x * s.x + s.y * s.y)
    made = System(
        "brake",
        states=states,
        parameters={
            name: (value, TABLE[NUMBERS_OF_A1[name]].units)
            if name in NUMBERS_OF_A1
            else (value, "rad")
            for name, value in defaults.items()
        },
        regimes=laws.belt.regimes(),
        field=field,
        switches=[
            *laws.contact_switches(free, holds),
            *laws.belt_switches(holds, limit, pull),
            *laws.knots(),
        ],
        start=dict.fromkeys(states, 0.0),
        starts_in=laws.starts(free, rises, limit, pull),
        outputs={"contact_force": ("N", force), "reach": reach},
        stops={} if rules.linear_springs else {"pivot1": pivot(0), "pivot2": pivot(1)},
        scales=scales,
    )
    _forms[traced] = made
    return made


_forms: dict[tuple[Any, ...], System] = {}
"""Systems by what of them is traced: tables whose values alone differ share one trace, which takes
a second or more."""


def on_belt(t: Any, s: Any, p: Any, r: Any) -> Any:
    """Speed of sliding, positive where the mass is slower than the belt."""
    return p.belt_speed - s.vx


class _Laws:
    """Regimes and switches of a friction law and a contact law, one or several pieces each."""

    def __init__(
        self, friction_law: str, contact_law: str, rules: Rules, *, one_mu: bool
    ) -> None:
        if not rules.drags and (is_table(friction_law) or is_table(contact_law)):
            raise ValueError(
                "friction as printed takes no tables; give a law by its name"
            )
        self.friction_law, self.contact_law = friction_law, contact_law
        self.rules, self.one_mu = rules, one_mu
        self.frictions: list[dict[str, float]] = [{}]
        self.contacts: list[dict[str, float]] = [{}]
        if is_table(friction_law):
            self.frictions = pieces_of(friction_law).constants("mu")
        if is_table(contact_law):
            self.contacts = pieces_of(contact_law, goes_on=True).constants("press")
        self.belt = BeltContact(
            frictions=self.frictions,
            presses=self.contacts,
            sticks=rules.sticks,
            apart=self.apart,
            speed=on_belt,
            unit=lambda p: p.friction_speed,
        )

    @property
    def form(self) -> tuple[Any, ...]:
        """Return the key of a trace: equal for laws that differ in regime constants alone."""
        friction: Any = self.friction_law
        contact: Any = self.contact_law
        if is_table(friction):
            friction = tuple(piece["mu_start"] for piece in self.frictions)
        if is_table(contact):
            contact = len(self.contacts)
        return friction, contact

    def of(self, p: Any, r: Any) -> tuple[Any, Geometry]:
        """Parameters as the laws read them, and direction cosines."""
        q = SimpleNamespace(**{name: getattr(p, name) for name in NUMBERS_OF_A1})
        q.friction_law, q.contact_law = self.friction_law, self.contact_law
        if self.one_mu:
            q.mu_static = None
            q.static_mu = friction_laws.static_coefficient(q)
        if not self.rules.drags:
            q.mu, q.static_mu = -q.mu, -q.static_mu
        if is_table(self.friction_law):
            q.friction_law = friction_laws.FrictionPiece(
                r.mu_start, (r.mu_c0, r.mu_c1, r.mu_c2, r.mu_c3)
            )
        if is_table(self.contact_law):
            coefficients = (r.press_c0, r.press_c1, r.press_c2, r.press_c3)
            q.contact_law = contact_laws.ContactPiece(r.press_start, coefficients)
        return q, Geometry(cos(p.alpha1), sin(p.alpha1), cos(p.alpha2), sin(p.alpha2))

    @property
    def apart(self) -> list[str]:
        """Regimes without contact; with a dashpot also within the spring's free length."""
        if not self.rules.separates:
            return []
        return ["separated", *(["released"] * (self.contact_law == "dashpot"))]

    def landing(self, kind: str, holds: Any) -> list[Any]:
        """Return the targets of a switch by which contact begins: the regime depends on the sliding
        speed.
        """

        def speed(t: Any, s: Any, p: Any, r: Any) -> Any:
            return p.belt_speed - s.vx * self.rules.reverses

        def stays(t: Any, s: Any, p: Any, r: Any) -> Any:
            return holds(t, s, p, r) - (DECIDES_FIRST * on_belt(t, s, p, r)) ** 2

        return self.belt.landing(kind, speed, stays)

    def contact_switches(self, free: Any, holds: Any) -> list[Switch]:
        """Return the switches at which contact is lost and found."""
        if not self.rules.separates:
            return []
        belt = self.belt
        first = [belt.name(*each) for each in belt.in_contact() if each[2] == 0]
        landing = self.landing("contact", holds)
        if self.contact_law != "dashpot":
            return [
                Switch("separation", first, negative(free), "separated"),
                Switch("contact", "separated", free, landing),
            ]

        def force(t: Any, s: Any, p: Any, r: Any) -> Any:
            return normal_force(s.y, s.vy, self.of(p, r)[0])

        return [
            Switch("separation", first, force, "released"),
            Switch("contact", "separated", free, landing),
            Switch("pressing", "released", negative(force), landing),
            Switch("clearance", "released", negative(free), "separated"),
        ]

    def belt_switches(self, holds: Any, limit: Any, pull: Any) -> Iterator[Switch]:
        """Return the switches at which the mass reaches belt speed, and at which stick ends."""
        if not self.rules.reverses:
            return
        for j in range(len(self.contacts)):
            yield from self.belt.belt_switches(
                holds,
                {
                    "slip": (
                        lambda t, s, p, r: limit(s, p, r) - pull(s, p, r),
                        "slip_faster",
                    ),
                    "slip_back": (
                        lambda t, s, p, r: limit(s, p, r) + pull(s, p, r),
                        "slip_slower",
                    ),
                },
                lambda t, s, p, r: {"vx": p.belt_speed},
                j,
            )

    def knots(self) -> Iterator[Switch]:
        """Return the switches at which a law goes over from one of its pieces to the next."""

        def presses(end: str) -> Surface:
            return lambda t, s, p, r: (
                p.preload - s.y - getattr(r, f"press_{end}") * p.preload
            )

        belt = self.belt
        yield from belt.friction_knots()
        for kind, i, j in belt.in_contact():
            if j + 1 < len(self.contacts):
                yield from knots(
                    belt.name(kind, i, j), belt.name(kind, i, j + 1), presses
                )

    def starts(self, free: Any, rises: Any, limit: Any, pull: Any) -> list[Any]:
        """Return the regimes in which a run may start; the first whose surfaces are all ≥ 0 counts.

        Where the contact spring is just free the velocity decides, then the force. At belt speed it
        is stick where friction can hold, or slip to the side that the springs pull to, below belt
        speed where they do not.
        """

        def above(t: Any, s: Any, p: Any, r: Any) -> Any:
            return DECIDES_FIRST * free(t, s, p, r) - p.preload

        entries: list[Any] = []
        for i, name in enumerate(self.apart):
            entries += [(name, None)] if i else [(name, rises, free), (name, above)]
        if not self.rules.reverses:
            return [
                *entries,
                ("slip_slower", lambda t, s, p, r: p.belt_speed),
                "slip_faster",
            ]
        regimes = [self.belt.name(*each) for each in self.belt.in_contact()]
        sticks = [name for name in regimes if name.startswith("stick")]
        slips = [name for name in regimes if name not in sticks]
        several = len(self.contacts) > 1

        def falls_back(t: Any, s: Any, p: Any, r: Any) -> Any:
            return -pull(s, p, r) - (DECIDES_FIRST * limit(s, p, r) if sticks else 0.0)

        if not several:
            entries.append((self.belt.name("slip_slower"), falls_back, on_belt))
        entries += [(name, None, on_belt) for name in sticks]
        if not several:
            faster = self.belt.name("slip_faster")
            entries.append((faster, lambda t, s, p, r: pull(s, p, r), on_belt))
        return [*entries, *((name, None) for name in slips[:-1]), slips[-1]]
