"""A1, its variants and A4 as one symbolic system: regime, parameters and angles are lane data."""

from __future__ import annotations

import threading
from types import SimpleNamespace
from typing import Any

import heyoka

from squealpipe.laws.contact import contact_force
from squealpipe.laws.springs import Geometry
from squealpipe.methods.lanes import HybridSystem, batch_integrator
from squealpipe.models import a1

PHYSICAL = ("k2", "k3", "mu", "belt_speed", "length1", "length2", "c1", "s1", "c2", "s2")
"""Parameters of a lane, in units of m = k1 = l_pre = 1."""
REGIME = (
    "contact",
    "direction",
    "stick",
    "gap_weight",
    "gap_offset",
    "speed_weight",
    "speed_offset",
)
"""What a regime sets: the terms of A1, and its switching surfaces as weights and offsets."""
PARAMETER_INDEX = {name: index for index, name in enumerate((*PHYSICAL, *REGIME))}
STATE = ("x", "y", "vx", "vy")
TANGENT = ("dx", "dy", "dvx", "dvy")


def lane_system(*, linear_springs: bool, tangent: bool) -> HybridSystem:
    """The symbolic system.

    Args:
        linear_springs: K r instead of the exact spring geometry.
        tangent: add the variational equation of one perturbation.
    """
    x, y, vx, vy = heyoka.make_vars(*STATE)
    lane = {name: heyoka.par[index] for name, index in PARAMETER_INDEX.items()}
    p = SimpleNamespace(mass=1.0, k1=1.0, preload=1.0, **{name: lane[name] for name in PHYSICAL})
    g = Geometry(p.c1, p.s1, p.c2, p.s2)
    stick = lane["stick"]
    ax, ay = a1.acceleration(
        x,
        y,
        p,
        g,
        contact=lane["contact"],
        direction=lane["direction"],
        stick=stick,
        linear_springs=linear_springs,
    )
    equations = [(x, vx), (y, vy), (vx, ax), (vy, ay)]
    if tangent:
        equations += _variational(x, y, ax, ay)
    fx, _ = a1.spring_force(x, y, p, g, linear_springs=linear_springs)
    limit = p.mu * contact_force(y, p)
    # A surface that a regime does not watch becomes the constant 1, which has no root. Offsets are
    # parameters because each operation of an event function costs as much as one of the field.
    return HybridSystem(
        equations=tuple(equations),
        events=(
            lane["gap_weight"] * y + lane["gap_offset"],
            lane["speed_weight"] * vx + stick * (limit - fx) + lane["speed_offset"],
            stick * (limit + fx) + (1.0 - stick),
        ),
    )


def _variational(x: Any, y: Any, ax: Any, ay: Any) -> list[tuple[Any, Any]]:
    dx, dy, dvx, dvy = heyoka.make_vars(*TANGENT)
    return [
        (dx, dvx),
        (dy, dvy),
        (dvx, heyoka.diff(ax, x) * dx + heyoka.diff(ax, y) * dy),
        (dvy, heyoka.diff(ay, x) * dx + heyoka.diff(ay, y) * dy),
    ]


_OF_THREAD = threading.local()


def lane_integrator(*, linear_springs: bool, tangent: bool, tol: float) -> Any:
    """The compiled batch integrator, built once a thread for each combination.

    An integrator holds the states of its lanes, so threads must not share one.
    """
    built = _OF_THREAD.__dict__.setdefault("integrators", {})
    key = (linear_springs, tangent, tol)
    if key not in built:
        system = lane_system(linear_springs=linear_springs, tangent=tangent)
        built[key] = batch_integrator(system, tol)
    return built[key]
