"""A forced oscillator with dry friction: ẍ + 2ζẋ + x + sgn ẋ = f cos ωt, with stick."""

from math import pi
from typing import Any

from squealpipe.systems.components import Switch
from squealpipe.systems.functions import cos
from squealpipe.systems.system import System


def _push(t: Any, s: Any, p: Any) -> Any:
    return p.force * cos(p.omega * t) - s.x


def _holds(t: Any, s: Any, p: Any, r: Any) -> Any:
    return 1.0 - _push(t, s, p) ** 2


dry_friction_oscillator = System(
    "forced oscillator with dry friction",
    states={"x": "m", "v": "m/s"},
    parameters={"damping_ratio": 0.05, "force": 1.5, "omega": 1.0},
    regimes={
        "right": {"direction": 1.0, "slips": 1.0},
        "left": {"direction": -1.0, "slips": 1.0},
        "stick": {"direction": 0.0, "slips": 0.0},
    },
    field=lambda t, s, p, r: {
        "x": r.slips * s.v,
        "v": r.slips * (_push(t, s, p) - 2.0 * p.damping_ratio * s.v - r.direction),
    },
    switches=[
        Switch(
            "reversal",
            leaves=("right", "left"),
            when=lambda t, s, p, r: r.direction * s.v,
            to=[
                ("stick", _holds, "stick"),
                ("left", lambda t, s, p, r: r.direction),
                "right",
            ],
            reset=lambda t, s, p, r: {"v": 0.0},
        ),
        Switch(
            "release_right", "stick", lambda t, s, p, r: 1.0 - _push(t, s, p), "right"
        ),
        Switch(
            "release_left", "stick", lambda t, s, p, r: 1.0 + _push(t, s, p), "left"
        ),
    ],
    start={"x": 0.0, "v": 0.0},
    starts_in=[
        ("stick", _holds, lambda t, s, p, r: s.v),
        ("right", lambda t, s, p, r: s.v),
        ("left", lambda t, s, p, r: -s.v),
        "right",
    ],
    period=lambda p: 2 * pi / p.omega,
)
