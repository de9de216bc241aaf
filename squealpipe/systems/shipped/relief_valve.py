"""A pressure relief valve whose disc hits its seat, with its chamber's pressure.

ẏ1 = y2, ẏ2 = −κ y2 − (y1 + δ) + y3, ẏ3 = β (q − y1 √y3); impact at y1 = 0.
"""

from squealpipe.systems.components import Switch
from squealpipe.systems.functions import sqrt
from squealpipe.systems.system import System

relief_valve = System(
    "pressure relief valve",
    states={"y1": "1", "y2": "1", "y3": "1"},
    parameters={
        "kappa": 1.25,
        "beta": 20.0,
        "delta": 10.0,
        "q": 8.0,
        "restitution": 0.8,
    },
    regimes={"open": {}},
    field=lambda t, s, p, r: {
        "y1": s.y2,
        "y2": -p.kappa * s.y2 - (s.y1 + p.delta) + s.y3,
        "y3": p.beta * (p.q - s.y1 * sqrt(s.y3)),
    },
    switches=[
        Switch(
            "impact",
            leaves="open",
            when=lambda t, s, p, r: s.y1,
            to="open",
            reset=lambda t, s, p, r: {"y2": -p.restitution * s.y2},
        )
    ],
    start={"y1": 1.0, "y2": 0.0, "y3": 11.0},
)
