"""A ball that bounces on the floor; its impacts accumulate."""

from squealpipe.systems.components import Switch
from squealpipe.systems.system import System

bouncing_ball = System(
    "bouncing ball",
    states={"y": "m", "v": "m/s"},
    parameters={"gravity": 9.81, "restitution": 0.9},
    regimes={"flight": {}},
    field=lambda t, s, p, r: {"y": s.v, "v": -p.gravity},
    switches=[
        Switch(
            "impact",
            leaves="flight",
            when=lambda t, s, p, r: s.y,
            to="flight",
            reset=lambda t, s, p, r: {"v": -p.restitution * s.v},
        )
    ],
    start={"y": 1.0, "v": 0.0},
)
