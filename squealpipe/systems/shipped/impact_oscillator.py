"""A forced oscillator that hits a stop: ẍ + c ẋ + x = A cos ωt, x ≤ gap."""

from math import pi

from squealpipe.systems.components import Switch
from squealpipe.systems.functions import cos
from squealpipe.systems.system import System

impact_oscillator = System(
    "impact oscillator",
    states={"x": "m", "v": "m/s"},
    parameters={
        "amplitude": 0.5,
        "omega": 1.9,
        "damping": 0.1,
        "gap": 1.0,
        "restitution": 0.8,
    },
    regimes={"free": {}},
    field=lambda t, s, p, r: {
        "x": s.v,
        "v": p.amplitude * cos(p.omega * t) - p.damping * s.v - s.x,
    },
    switches=[
        Switch(
            "impact",
            leaves="free",
            when=lambda t, s, p, r: p.gap - s.x,
            to="free",
            reset=lambda t, s, p, r: {"v": -p.restitution * s.v},
        )
    ],
    start={"x": 0.0, "v": 0.0},
    period=lambda p: 2 * pi / p.omega,
)
