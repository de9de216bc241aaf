"""Textbook systems whose cycles, tori and chaos are known."""

import numpy as np

from squealpipe import Switch, System
from squealpipe.functions import cos, sin


def oscillator(name, acceleration, *, start=None, **parameters):
    """x″ = acceleration(t, x, v, p), forced with ``omega`` if there is such a parameter."""
    forced = (
        {"period": lambda p: 2.0 * np.pi / p.omega} if "omega" in parameters else {}
    )
    return System(
        name,
        states={"x": "1", "v": "1"},
        parameters=parameters,
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": acceleration(t, s.x, s.v, p)},
        start={"x": 1.0, "v": 0.0} if start is None else start,
        **forced,
    )


linear = oscillator(
    "forced linear oscillator",
    lambda t, x, v, p: -x - p.damping * v + cos(p.omega * t),
    start={"x": 0.0, "v": 0.0},
    omega=1.2,
    damping=0.2,
)
duffing_holmes = oscillator(
    "Duffing and Holmes",
    lambda t, x, v, p: x - x**3 - p.damping * v + p.force * cos(p.omega * t),
    omega=1.2,
    damping=0.2,
    force=0.3,
)
ueda = oscillator(
    "Duffing's oscillator without a linear spring",
    lambda t, x, v, p: -(x**3) - p.damping * v + p.force * cos(p.omega * t),
    omega=1.0,
    damping=0.1,
    force=1.0,
)
pendulum = oscillator("pendulum", lambda t, x, v, p: -sin(x))
van_der_pol = oscillator(
    "van der Pol",
    lambda t, x, v, p: p.mu * (1.0 - x**2) * v - x,
    start={"x": 2.0, "v": 0.0},
    mu=1.0,
)
elastic_ball = System(
    "elastic ball",
    states={"x": "m", "v": "m/s"},
    parameters={"gravity": 1.0, "restitution": 1.0},
    regimes={"free": {}},
    field=lambda t, s, p, r: {"x": s.v, "v": -p.gravity},
    switches=[
        Switch(
            "hit",
            "free",
            lambda t, s, p, r: s.x,
            "free",
            reset=lambda t, s, p, r: {"v": -p.restitution * s.v},
        )
    ],
    start={"x": 1.0, "v": 0.0},
)


def two_oscillators(squared):
    """Two undamped oscillators that do not know of each other: 1, and a frequency squared."""
    return System(
        "two oscillators",
        states=dict.fromkeys(("x", "v", "y", "w"), "1"),
        parameters={"squared": squared},
        regimes={"all": {}},
        field=lambda t, s, p, r: {"x": s.v, "v": -s.x, "y": s.w, "w": -p.squared * s.y},
        start={"x": 1.0, "v": 0.0, "y": 1.0, "w": 0.0},
    )


def square_wave(stiffness=1.0):
    """A linear oscillator under a force that changes its sign at instants alone."""
    return System(
        "square wave",
        states={"x": "1", "v": "1"},
        parameters={"omega": 1.2, "damping": 0.2},
        regimes={"up": {"force": 1.0}, "down": {"force": -1.0}},
        field=lambda t, s, p, r: {
            "x": s.v,
            "v": r.force - p.damping * s.v - stiffness * s.x,
        },
        switches=[
            Switch("falls", "up", lambda t, s, p, r: sin(p.omega * t), "down"),
            Switch("rises", "down", lambda t, s, p, r: -sin(p.omega * t), "up"),
        ],
        start={"x": 0.0, "v": 0.0, "regime": "up"},
        period=lambda p: 2.0 * np.pi / p.omega,
    )


def _push(t, p):
    return p.strength * sin(p.omega * t)


def _stays(t, s, p, r):
    return 1.0 + p.adhesion - _push(t, p)


def _stopped(t, s, p, r):
    return {"v": 0.0}


ball_on_a_table = System(
    "inelastic ball on a vibrating table, seen from it",
    states={"x": "1", "v": "1"},
    parameters={"omega": 1.0, "strength": 1.5, "adhesion": 1e-3},
    regimes={"free": {"free": 1.0}, "rest": {"free": 0.0}},
    field=lambda t, s, p, r: {
        "x": r.free * s.v,
        "v": r.free * (p.strength * sin(p.omega * t) - 1.0),
    },
    switches=[
        Switch(
            "land",
            "free",
            lambda t, s, p, r: s.x,
            to=[("rest", _stays), "free"],
            reset=lambda t, s, p, r: {"x": 0.0, "v": 0.0},
        ),
        Switch("leave", "rest", _stays, "free"),
    ],
    start={"x": 0.0, "v": 0.0, "regime": "rest"},
    period=lambda p: 2.0 * np.pi / p.omega,
)
"""Its acceleration is that of gravity, 1, less the table's; it leaves at an instant alone.

A little adhesion is overcome first: without, it would leave with neither speed nor acceleration.
"""
block_on_a_table = System(
    "block that slides on a table shaken to and fro",
    states={"x": "1", "v": "1"},
    parameters={"omega": 1.0, "strength": 1.3},
    regimes={
        "stick": {"slip": 0.0, "sign": 1.0},
        "forwards": {"slip": 1.0, "sign": 1.0},
        "backwards": {"slip": 1.0, "sign": -1.0},
    },
    field=lambda t, s, p, r: {
        "x": r.slip * s.v - p.omega * s.x,
        "v": r.slip * (p.strength * sin(p.omega * t) - r.sign),
    },
    switches=[
        Switch("moves_on", "stick", lambda t, s, p, r: 1.0 - _push(t, p), "forwards"),
        Switch(
            "moves_back", "stick", lambda t, s, p, r: 1.0 + _push(t, p), "backwards"
        ),
        Switch("stops", "forwards", lambda t, s, p, r: s.v, "stick", _stopped),
        Switch("stops_back", "backwards", lambda t, s, p, r: -s.v, "stick", _stopped),
    ],
    start={"x": 0.0, "v": 0.0, "regime": "stick"},
    period=lambda p: 2.0 * np.pi / p.omega,
)
"""v is its speed on the table, over friction; it begins to move at instants alone.

x is that speed behind a filter, so that the cycle is one of more than events.
"""
