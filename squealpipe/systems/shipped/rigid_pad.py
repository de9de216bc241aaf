"""A rigid pad on two springs, with a contact at its leading and one at its trailing edge.

The pad moves by x and y and turns by θ. Each lower edge, ``half_length`` from the centre and
``depth`` below it, is pressed on the belt by a contact spring and lifts off alone; a spring hangs
each upper edge from a fixed point above it. The belt is faster than any edge, so friction μN pulls
both along +x; ``work`` is what friction has done since the start.
"""

from typing import Any

from squealpipe.systems.components import Component, Switch
from squealpipe.systems.functions import cos, sin, sqrt
from squealpipe.systems.system import System

LEADING, TRAILING = 1.0, -1.0


def edge(side: float, s: Any, p: Any) -> tuple[Any, Any]:
    """(x, y) of a lower edge from the centre, m; the upper edge is ``-edge(-side)``."""
    x, y = side * p.half_length, -p.depth
    return x * cos(s.theta) - y * sin(s.theta), x * sin(s.theta) + y * cos(s.theta)


def approach(side: float, s: Any, p: Any) -> Any:
    """Return the compression of an edge's contact spring, m."""
    return p.preload - s.y - edge(side, s, p)[1] - p.depth


def spring(side: float, s: Any, p: Any) -> tuple[Any, Any, Any]:
    """(length, x, y) of a spring, from where it is fixed to the pad, m."""
    other_x, other_y = edge(-side, s, p)
    x = s.x - other_x - side * p.half_length
    y = s.y - other_y - p.depth - p.free_length
    return sqrt(x * x + y * y), x, y


def _field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
    total: list[Any] = [0.0, 0.0, 0.0, 0.0]
    for side, own in ((LEADING, r.leading), (TRAILING, r.trailing)):
        x, y = edge(side, s, p)
        normal = own.contact * p.contact_stiffness * approach(side, s, p)
        length, dx, dy = spring(side, s, p)
        pull = p.stiffness * (1.0 - p.free_length / length)
        other_x, other_y = edge(-side, s, p)
        parts = (
            p.mu * normal - pull * dx,
            normal - pull * dy,
            normal * (x - p.mu * y) + pull * (other_x * dy - other_y * dx),
            p.mu * normal * (s.vx - s.spin * y),
        )
        total = [a + b for a, b in zip(total, parts, strict=True)]
    fx, fy, moment, power = total
    return {
        "x": s.vx,
        "y": s.vy,
        "theta": s.spin,
        "work": power,
        "vx": fx / p.mass,
        "vy": fy / p.mass,
        "spin": moment / p.inertia,
    }


def _contact(side: float) -> Component:
    """An edge that lifts off and lands, whatever the other does."""
    return Component(
        regimes={"closed": {"contact": 1.0}, "open": {"contact": 0.0}},
        switches=[
            Switch("lifts", "closed", lambda t, s, p, r: approach(side, s, p), "open"),
            Switch("lands", "open", lambda t, s, p, r: -approach(side, s, p), "closed"),
        ],
    )


rigid_pad = System(
    "rigid pad on two springs",
    states={
        "x": "m",
        "y": "m",
        "theta": "rad",
        "vx": "m/s",
        "vy": "m/s",
        "spin": "rad/s",
        "work": "J",
    },
    parameters={
        "mass": 1.0,
        "inertia": 0.5,
        "stiffness": 1.0,
        "free_length": 3.0,
        "half_length": 1.0,
        "depth": 0.5,
        "contact_stiffness": 2.0,
        "preload": 1.0,
        "mu": 0.4,
    },
    components={"leading": _contact(LEADING), "trailing": _contact(TRAILING)},
    field=_field,
    start={
        "x": 0.0,
        "y": 0.0,
        "theta": 0.0,
        "vx": 0.0,
        "vy": 0.0,
        "spin": 0.0,
        "work": 0.0,
    },
)
