"""A gear pair with backlash: teeth touch on the drive flank, on the coast flank, or not at all.

The transmission error x of Kahraman and Singh (1990), in units of half the backlash and of the
period of the mesh: ẍ + 2ζẋ + g(x) = mean + amplitude cos ωt, where g is x − gap beyond the gap on
the drive side, x + gap on the coast side, and 0 between. Each flank is a component.
"""

from math import pi
from typing import Any

from squealpipe.systems.components import Component, Switch
from squealpipe.systems.functions import cos
from squealpipe.systems.system import System


def _approach(side: float, s: Any, p: Any) -> Any:
    """Return the depth to which a flank is pressed."""
    return side * s.x - p.gap


def _flank(side: float) -> Component:
    return Component(
        {"open": {"contact": 0.0}, "closed": {"contact": 1.0}},
        [
            Switch(
                "meets", "open", lambda t, s, p, r: -_approach(side, s, p), "closed"
            ),
            Switch("parts", "closed", lambda t, s, p, r: _approach(side, s, p), "open"),
        ],
    )


def _field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
    mesh = r.drive.contact * (s.x - p.gap) + r.coast.contact * (s.x + p.gap)
    load = p.mean + p.amplitude * cos(p.omega * t)
    return {"x": s.v, "v": load - 2.0 * p.damping * s.v - mesh}


gear_pair = System(
    "gear pair with backlash",
    states={"x": "1", "v": "1"},
    parameters={
        "mean": 0.1,
        "amplitude": 0.3,
        "omega": 0.7,
        "damping": 0.05,
        "gap": 1.0,
    },
    components={
        name: _flank(side) for name, side in {"drive": 1.0, "coast": -1.0}.items()
    },
    field=_field,
    start={"x": 1.1, "v": 0.0},
    period=lambda p: 2.0 * pi / p.omega,
)
