"""A1 kept pressed to the belt, with its derivatives by two parameters, as a system.

Until contact is first lost it is A1; beyond, the contact spring pulls. So the largest y of a run
says whether contact is lost, and each maximum of y and its slopes are smooth functions of the
parameters. What changes friction (belt speed, release) is a stop, for the slopes jump there.
All quantities are in units of m = k1 = l_pre = 1.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

from squealpipe.functions import cos, sin
from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.friction_laws import coefficient
from squealpipe.laws.springs import Geometry
from squealpipe.methods.taylor.symbols import Symbol, derivative, substituted, symbol, variables
from squealpipe.models import a1
from squealpipe.parameters import NUMBERS_OF_A1
from squealpipe.systems.system import Switch, System

STATES = ("x", "y", "vx", "vy")
PARAMETERS = (*NUMBERS_OF_A1, "alpha1", "alpha2")
FRICTION = {"slower": (1.0, 0.0), "faster": (-1.0, 0.0), "stick": (0.0, 1.0)}
"""Friction of a regime: direction sgn(V − ẋ), and whether it sticks."""
REGIMES = tuple(f"{friction}_{way}" for friction in FRICTION for way in ("up", "down"))
"""Friction and whether y rises."""

Group = tuple[str, ...]
"""Parameters that vary together."""


class Pressed:
    """The equations of one kind of system, as functions of a state and parameters.

    Args:
        law: name of the friction law.
        damped: with dashpots.
        linear_springs, drags: as in :data:`squealpipe.models.switching.VARIANT_RULES`.
    """

    def __init__(self, law: str, *, damped: bool, linear_springs: bool, drags: bool) -> None:
        self.law, self.damped, self.linear = law, damped, linear_springs
        self.sign = 1.0 if drags else -1.0

    def _of(self, p: Any) -> tuple[Any, Geometry]:
        named = {name: getattr(p, name) for name in NUMBERS_OF_A1}
        g = Geometry(cos(p.alpha1), sin(p.alpha1), cos(p.alpha2), sin(p.alpha2))
        return SimpleNamespace(friction_law=self.law, **named), g

    def accelerations(self, s: Any, p: Any, r: Any) -> tuple[Any, Any]:
        """(ẍ, ÿ) in a regime."""
        q, _ = self._of(p)
        speed = r.direction * (q.belt_speed - s.vx)
        mu = coefficient(speed, q)
        fx, fy = self._suspension(s, p)
        normal, inverse_mass = contact_force(s.y, q), q.mass**-1.0
        friction = self.sign * mu * normal * r.direction
        return (1.0 - r.stick) * inverse_mass * (fx + friction), inverse_mass * (fy + normal)

    def margins(self, s: Any, p: Any) -> tuple[Any, Any]:
        """μs N ∓ the x-force of the springs: positive while a mass at belt speed sticks."""
        q, _ = self._of(p)
        limit, (pull, _) = stick_limit(contact_force(s.y, q), q), self._suspension(s, p)
        return limit - pull, limit + pull

    def _suspension(self, s: Any, p: Any) -> tuple[Any, Any]:
        return a1.suspension_force(
            s.x, s.y, s.vx, s.vy, *self._of(p),
            linear_springs=self.linear, dashpots=self.damped,
        )  # fmt: skip


def slope_names(number: int) -> tuple[str, ...]:
    """The states that are the derivatives of :data:`STATES` by varied parameter ``number``."""
    return tuple(f"{state}_by{number}" for state in STATES)


@cache
def pressed(
    law: str,
    groups: tuple[Group, ...],
    *,
    damped: bool,
    linear_springs: bool,
    reverses: bool,
    drags: bool,
) -> System:
    """The system with its variational equations.

    Args:
        groups: parameters that vary together, for each derivative; how much each of them changes
            is a parameter of the system, ``change{number}_{name}``.
        law, damped, linear_springs, drags: see :class:`Pressed`.
        reverses: whether belt speed is a surface.
    """
    equations = Pressed(law, damped=damped, linear_springs=linear_springs, drags=drags)
    states = (*STATES, *(name for i in range(len(groups)) for name in slope_names(i)))
    changes = {f"change{i}_{name}": 1.0 for i, group in enumerate(groups) for name in group}

    def field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        moving = {name: getattr(p, name) for name in PARAMETERS}
        placed = {name: variables(f"moving {name}")[0] for group in groups for name in group}
        held = {id(variable): moving[name] for name, variable in placed.items()}
        found = equations.accelerations(s, SimpleNamespace(**(moving | placed)), r)
        rates: dict[str, Any] = {"x": s.vx, "y": s.vy}
        for name, value in zip(("vx", "vy"), found, strict=True):
            rates[name] = substituted(symbol(value), held)

        def slope(value: Symbol, by: Symbol) -> Symbol:
            return substituted(symbol(derivative(value, by)), held)

        for i, group in enumerate(groups):
            deltas = dict(zip(STATES, (getattr(s, name) for name in slope_names(i)), strict=True))
            x, y, vx, vy = slope_names(i)
            rates |= {x: deltas["vx"], y: deltas["vy"]}
            for name, value in zip((vx, vy), found, strict=True):
                total: Any = symbol(0.0)
                for state, delta in deltas.items():
                    total = total + slope(value, getattr(s, state)) * delta
                for each in group:
                    total = total + slope(value, placed[each]) * getattr(p, f"change{i}_{each}")
                rates[name] = total
        return rates

    def speed(t: Any, s: Any, p: Any, r: Any) -> Any:
        return r.direction * (p.belt_speed - s.vx) + r.stick

    def margin(which: int) -> Any:
        return lambda t, s, p, r: r.stick * equations.margins(s, p)[which] + (1.0 - r.stick)

    turns = [
        Switch(
            f"{kind} {friction}", f"{friction}_{before}",
            lambda t, s, p, r: r.way * s.vy, [(f"{friction}_{after}", None, kind)],
        )
        for friction in FRICTION
        for kind, before, after in (("maximum", "up", "down"), ("minimum", "down", "up"))
    ]  # fmt: skip
    stops = {"belt_speed": speed, "release": margin(0), "release_back": margin(1)}
    return System(
        "pressed brake",
        states=dict.fromkeys(states, "1"),
        parameters=dict.fromkeys(PARAMETERS, 1.0) | changes | {"first_regime": 0.0},
        regimes={
            name: {
                "direction": FRICTION[name.split("_")[0]][0],
                "stick": FRICTION[name.split("_")[0]][1],
                "way": 1.0 if name.endswith("up") else -1.0,
            }
            for name in REGIMES
        },
        field=field,
        switches=turns,
        start=dict.fromkeys(states, 0.0),
        starts_in=[
            *(
                (name, lambda t, s, p, r, i=i: 0.25 - (p.first_regime - i) ** 2)
                for i, name in enumerate(REGIMES[:-1])
            ),
            REGIMES[-1],
        ],
        stops=stops if reverses else {},
    )
