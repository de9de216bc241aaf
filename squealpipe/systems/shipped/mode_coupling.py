"""Two coupled modes that friction makes flutter, with contact that can be lost.

Hoffmann, Fischer, Allgaier and Gaul (2002), about steady sliding, with y towards the belt: in
contact the stiffness matrix is [[k11, k12 + μ kc], [k12, k22 + kc]]. Contact is lost at
y = −approach, where the force kc (y + approach) is zero. The modes merge, and flutter begins, at
μ = 0.75.
"""

from typing import Any

from squealpipe.systems.components import Switch
from squealpipe.systems.system import System


def _field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
    # what the contact force differs from that of steady sliding
    force = p.kc * (r.contact * (s.y + p.approach) - p.approach)
    return {
        "x": s.vx,
        "y": s.vy,
        "vx": -p.k11 * s.x - p.k12 * s.y - p.mu * force,
        "vy": -p.k12 * s.x - p.k22 * s.y - force,
    }


mode_coupling = System(
    "mode coupling with contact loss",
    states={"x": "m", "y": "m", "vx": "m/s", "vy": "m/s"},
    parameters={
        "mu": 0.9,
        "k11": 2.0,
        "k12": -1.0,
        "k22": 2.0 / 3.0,
        "kc": 4.0 / 3.0,
        "approach": 1.0,
    },
    regimes={"contact": {"contact": 1.0}, "separated": {"contact": 0.0}},
    field=_field,
    switches=[
        Switch(
            "separation", "contact", lambda t, s, p, r: s.y + p.approach, to="separated"
        ),
        Switch(
            "contact", "separated", lambda t, s, p, r: -s.y - p.approach, to="contact"
        ),
    ],
    start={"x": 1e-3, "y": 0.0, "vx": 0.0, "vy": 0.0},
)
