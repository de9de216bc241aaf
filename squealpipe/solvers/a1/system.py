"""A1, its variants and A4 as one symbolic system: regime, parameters and angles are lane data."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import NamedTuple

from squealpipe.laws.contact import contact_force
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction import stick_limit
from squealpipe.laws.friction_laws import COULOMB, LAWS
from squealpipe.laws.functions import exp
from squealpipe.laws.springs import Geometry
from squealpipe.methods.taylor import symbols
from squealpipe.methods.taylor.lanes import CompiledSystem, compile_system
from squealpipe.methods.taylor.series import HybridSystem
from squealpipe.models import a1
from squealpipe.parameters import NUMBERS_OF_A1, TABLE

EXTENSIONS = tuple(name for name, given in NUMBERS_OF_A1.items() if TABLE[given].extension)
"""What goes beyond the paper; read by the systems that need it alone (:class:`Dissipation`)."""
UNITS = ("mass", "k1", "preload")
"""Parameters that are 1 in the engine's units; laws and switching rules ask for them by name."""
PHYSICAL = (
    tuple(name for name in NUMBERS_OF_A1 if name not in {*UNITS, *EXTENSIONS}) + Geometry._fields
)
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
PARAMETERS = (*PHYSICAL, *EXTENSIONS, *REGIME)
STATE = ("x", "y", "vx", "vy")


class Dissipation(NamedTuple):
    """Which forces a compiled system has; the paper's alone by default.

    Each combination is a system of its own, so that the paper's costs nothing more.

    Attributes:
        law: name of the friction law.
        damped: with dashpots.
        static_apart: the static coefficient differs from that of sliding.
        long1, long2: springs that take the form for long ones.
    """

    law: str = COULOMB
    damped: bool = False
    static_apart: bool = False
    long1: bool = False
    long2: bool = False


PAPER = Dissipation()
DISSIPATIONS = [
    Dissipation(law, damped, apart, long1, long2)
    for long1 in (False, True)
    for long2 in (False, True)
    for law in LAWS
    for damped in (False, True)
    for apart in ((False, True) if law == COULOMB else (True,))
]

exp.register(symbols.Symbol, symbols.exp)


def lane_system(*, linear_springs: bool, dissipation: Dissipation = PAPER) -> HybridSystem:
    """The symbolic system.

    Args:
        linear_springs: K r instead of the exact spring geometry.
        dissipation: the forces that it has.
    """
    x, y, vx, vy = symbols.variables(*STATE)
    lane = {name: symbols.parameter(name) for name in PARAMETERS}
    p = SimpleNamespace(
        mass=1.0,
        k1=1.0,
        preload=1.0,
        friction_law=dissipation.law,
        contact_law=LINEAR,
        **{name: lane[name] for name in (*PHYSICAL, *EXTENSIONS)},
    )
    if not dissipation.damped:
        p.damping1 = p.damping2 = 0.0
    if not dissipation.static_apart:
        p.static_mu = p.mu
    g = Geometry(p.c1, p.s1, p.c2, p.s2)
    stick = lane["stick"]
    ax, ay = a1.acceleration(
        x,
        y,
        vx,
        vy,
        p,
        g,
        contact=lane["contact"],
        direction=lane["direction"],
        stick=stick,
        linear_springs=linear_springs,
        long_springs=(dissipation.long1, dissipation.long2),
    )
    fx, _ = a1.suspension_force(
        x, y, vx, vy, p, g,
        linear_springs=linear_springs, long_springs=(dissipation.long1, dissipation.long2),
    )  # fmt: skip
    limit = stick_limit(contact_force(y, p), p)
    # A surface that a regime does not watch becomes the constant 1, which has no root.
    return HybridSystem(
        variables=(x, y, vx, vy),
        rates=(vx, vy, ax, ay),
        events=(
            lane["gap_weight"] * y + lane["gap_offset"],
            lane["speed_weight"] * vx + stick * (limit - fx) + lane["speed_offset"],
            stick * (limit + fx) + (1.0 - stick),
        ),
        parameters=PARAMETERS,
    )


@cache
def compiled_system(
    *, linear_springs: bool, dissipation: Dissipation, tangent: bool, few: bool = False
) -> CompiledSystem:
    """The compiled series of a system, built once a process for each combination."""
    system = lane_system(linear_springs=linear_springs, dissipation=dissipation)
    return compile_system(system, tangent=tangent, few=few)
