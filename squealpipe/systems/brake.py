"""The brake pad of A1 as a system: exact springs and dashpots, contact loss, friction with stick.

``brake(law)`` is the system for one friction law. Its parameters are those of ``Parameters`` and
both angles; the laws are those of :mod:`squealpipe.laws`.
"""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

from squealpipe.functions import cos, sin
from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.friction_laws import COULOMB
from squealpipe.laws.springs import Geometry, fixed_ends, squared_distance
from squealpipe.models import a1
from squealpipe.parameters import DEFAULTS, NUMBERS_OF_A1, Parameters
from squealpipe.systems.system import Switch, System

REGIMES = {
    "slip_slower": {"contact": 1.0, "direction": 1.0, "stick": 0.0},
    "slip_faster": {"contact": 1.0, "direction": -1.0, "stick": 0.0},
    "stick": {"contact": 1.0, "direction": 0.0, "stick": 1.0},
    "separated": {"contact": 0.0, "direction": 0.0, "stick": 0.0},
}
PIVOT_REACH2 = 1e-14
"""Squared distance from a pivot, in free lengths, below which the force's direction is lost."""


def parameters_of_run(params: Parameters, alpha1: float, alpha2: float) -> dict[str, float]:
    """What a run of :func:`brake` is given."""
    found = {name: getattr(params, name) for name in NUMBERS_OF_A1}
    return {**found, "alpha1": alpha1, "alpha2": alpha2}


@cache
def brake(friction_law: str = COULOMB, *, damped: bool = False) -> System:
    """A1 with one friction law.

    Args:
        friction_law: its name.
        damped: with dashpots; without, ``damping1`` and ``damping2`` are not read.
    """
    defaults = {
        name: DEFAULTS[of] if DEFAULTS[of] is not None else DEFAULTS["mu"]
        for name, of in NUMBERS_OF_A1.items()
    }

    def of(p: Any) -> tuple[Any, Geometry]:
        named = {name: getattr(p, name) for name in NUMBERS_OF_A1}
        g = Geometry(cos(p.alpha1), sin(p.alpha1), cos(p.alpha2), sin(p.alpha2))
        return SimpleNamespace(friction_law=friction_law, **named), g

    def field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        ax, ay = a1.acceleration(
            s.x, s.y, s.vx, s.vy, *of(p),
            contact=r.contact, direction=r.direction, stick=r.stick, dashpots=damped,
        )  # fmt: skip
        return {"x": s.vx, "y": s.vy, "vx": ax, "vy": ay}

    def pull(s: Any, p: Any) -> Any:
        return a1.suspension_force(
            s.x, s.y, s.vx, s.vy, *of(p), linear_springs=False, dashpots=damped
        )[0]

    def limit(s: Any, p: Any) -> Any:
        q, _ = of(p)
        return stick_limit(contact_force(s.y, q), q)

    def holds(t: Any, s: Any, p: Any, r: Any) -> Any:
        return limit(s, p) ** 2 - pull(s, p) ** 2

    def pivot(spring: int) -> Any:
        def near(t: Any, s: Any, p: Any, r: Any) -> Any:
            q, g = of(p)
            ends, length = fixed_ends(q, g), (p.length1, p.length2)[spring]
            distance = squared_distance(s.x, s.y, ends[2 * spring], ends[2 * spring + 1])
            return distance - PIVOT_REACH2 * length * length

        return near

    def force(t: Any, s: Any, p: Any, r: Any) -> Any:
        return r.contact * contact_force(s.y, of(p)[0])

    return System(
        "brake",
        states={"x": "m", "y": "m", "vx": "m/s", "vy": "m/s"},
        parameters={**defaults, "alpha1": 1.0, "alpha2": 1.0},
        regimes=REGIMES,
        field=field,
        switches=[
            Switch(
                "separation",
                leaves=("slip_slower", "slip_faster", "stick"),
                when=lambda t, s, p, r: p.preload - s.y,
                to="separated",
            ),
            Switch(
                "contact",
                leaves="separated",
                when=lambda t, s, p, r: s.y - p.preload,
                to=[("slip_slower", lambda t, s, p, r: p.belt_speed - s.vx), "slip_faster"],
            ),
            Switch(
                "reversal",
                leaves=("slip_slower", "slip_faster"),
                when=lambda t, s, p, r: r.direction * (p.belt_speed - s.vx),
                to=[
                    ("stick", holds, "stick"),
                    ("slip_faster", lambda t, s, p, r: r.direction),
                    "slip_slower",
                ],
                reset=lambda t, s, p, r: {"vx": p.belt_speed},
            ),
            Switch("slip", "stick", lambda t, s, p, r: limit(s, p) - pull(s, p), "slip_faster"),
            Switch(
                "slip_back",
                leaves="stick",
                when=lambda t, s, p, r: limit(s, p) + pull(s, p),
                to=[("slip_slower", None, "slip")],
            ),
        ],
        start={"x": 0.0, "y": 0.0, "vx": 0.0, "vy": 0.0},
        starts_in=[
            ("separated", lambda t, s, p, r: s.y - p.preload),
            ("stick", holds, lambda t, s, p, r: p.belt_speed - s.vx),
            ("slip_slower", lambda t, s, p, r: p.belt_speed - s.vx),
            "slip_faster",
        ],
        outputs={"contact_force": ("N", force)},
        stops={"pivot1": pivot(0), "pivot2": pivot(1)},
        time_scale=lambda p: (p.mass / p.k1) ** 0.5,
    )
