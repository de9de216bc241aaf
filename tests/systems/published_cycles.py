"""Published systems with cycles, and their return maps by SciPy."""

from typing import NamedTuple

import numpy as np

from squealpipe import Switch, System
from squealpipe.functions import cos, sin
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from tests.systems.smooth_systems import duffing_holmes, oscillator, ueda, van_der_pol


def smooth(name, field, start, **parameters):
    """A system of one regime without forcing."""
    return System(
        name,
        states=dict.fromkeys(start, "1"),
        parameters=parameters,
        regimes={"all": {}},
        field=lambda t, s, p, r: field(s, p),
        start=start,
    )


brusselator = smooth(
    "Brusselator",
    lambda s, p: {
        "x": p.a + s.x**2 * s.y - (p.b + 1.0) * s.x,
        "y": p.b * s.x - s.x**2 * s.y,
    },
    {"x": 1.0, "y": 1.0},
    a=1.0,
    b=3.0,
)
fitzhugh_nagumo = smooth(
    "FitzHugh and Nagumo",
    lambda s, p: {
        "v": s.v - s.v**3 / 3.0 - s.w + p.current,
        "w": 0.08 * (s.v + 0.7 - 0.8 * s.w),
    },
    {"v": 0.0, "w": 0.0},
    current=0.5,
)
roessler = smooth(
    "Rössler",
    lambda s, p: {"x": -s.y - s.z, "y": s.x + 0.2 * s.y, "z": 0.2 + s.z * (s.x - p.c)},
    {"x": 1.0, "y": 1.0, "z": 0.0},
    c=2.5,
)
lorenz = smooth(
    "Lorenz",
    lambda s, p: {
        "x": 10.0 * (s.y - s.x),
        "y": s.x * (p.r - s.z) - s.y,
        "z": s.x * s.y - 8.0 / 3.0 * s.z,
    },
    {"x": 1.0, "y": 1.0, "z": 20.0},
    r=28.0,
)
lotka_volterra = smooth(
    "Lotka and Volterra",
    lambda s, p: {"x": s.x * (1.0 - s.y), "y": p.rate * s.y * (s.x - 1.0)},
    {"x": 1.5, "y": 1.0},
    rate=1.0,
)
forced_pendulum = oscillator(
    "forced pendulum",
    lambda t, x, v, p: -sin(x) - p.damping * v + p.force * cos(p.omega * t),
    start={"x": 0.1, "v": 0.0},
    omega=2.0 / 3.0,
    damping=0.5,
    force=0.9,
)
walker = System(
    "Garcia's simplest walker",
    states=dict.fromkeys(("theta", "phi", "w", "u"), "1"),
    parameters={"slope": 0.009},
    regimes={"first": {}, "second": {}},
    field=lambda t, s, p, r: {
        "theta": s.w,
        "phi": s.u,
        "w": sin(s.theta - p.slope),
        "u": sin(s.theta - p.slope) + (s.w**2 - cos(s.theta - p.slope)) * sin(s.phi),
    },
    switches=[
        Switch("pass", "first", lambda t, s, p, r: s.phi - 2.0 * s.theta, "second"),
        Switch(
            "strike",
            "second",
            lambda t, s, p, r: 2.0 * s.theta - s.phi,
            "first",
            reset=lambda t, s, p, r: {
                "theta": -s.theta,
                "phi": -2.0 * s.theta,
                "w": cos(2.0 * s.theta) * s.w,
                "u": cos(2.0 * s.theta) * (1.0 - cos(2.0 * s.theta)) * s.w,
            },
        ),
    ],
    start={"theta": 0.2, "phi": 0.4, "w": -0.2, "u": -0.0157, "regime": "first"},
)
"""Between the legs' passing and the strike it is in its second regime."""


def _above_ramp(t, s, p, r):
    return 8.4 * (s.v - 11.3) - 3.8 - 4.4 * s.ramp


def _on_surface(t, s, p, r):
    return {"x": 0.0}


buck = System(
    "buck converter",
    states={"v": "V", "i": ("A", 0.1), "ramp": "1"},
    parameters={"supply": 20.0},
    regimes={"on": {"on": 1.0}, "off": {"on": 0.0}},
    field=lambda t, s, p, r: {
        "v": (s.i - s.v / 22.0) / 47e-6,
        "i": (r.on * p.supply - s.v) / 20e-3,
        "ramp": 1.0 / 400e-6,
    },
    switches=[
        Switch("opens", "on", lambda t, s, p, r: -_above_ramp(t, s, p, r), "off"),
        Switch("closes", "off", _above_ramp, "on"),
        Switch(
            "restarts",
            ("on", "off"),
            lambda t, s, p, r: 1.0 - s.ramp,
            to=[("off", lambda t, s, p, r: 8.4 * (s.v - 11.3) - 3.8), "on"],
            reset=lambda t, s, p, r: {"ramp": 0.0},
        ),
    ],
    start={"v": 12.0, "i": 0.55, "ramp": 0.0, "regime": "off"},
    time_scale=1e-4,
)
"""Deane and Hamill's circuit: its ramp, of 400 μs, is a state."""

relay = System(
    "relay feedback",
    states=dict.fromkeys(("x", "y", "z"), "1"),
    parameters={"omega": 25.0, "damping": 0.05, "zero": 1.0},
    regimes={
        "above": {"free": 1.0, "push": -1.0},
        "below": {"free": 1.0, "push": 1.0},
        "slides": {"free": 0.0, "push": 0.0},
    },
    field=lambda t, s, p, r: {
        "x": r.free * (s.y + r.push - (2.0 * p.damping * p.omega + 1.0) * s.x),
        "y": s.z
        - 2.0 * p.zero * (r.push - (1.0 - r.free) * s.y)
        - (2.0 * p.damping * p.omega + p.omega**2) * s.x,
        "z": r.push - (1.0 - r.free) * s.y - p.omega**2 * s.x,
    },
    switches=[
        Switch(
            "down",
            "above",
            lambda t, s, p, r: s.x,
            [("slides", lambda t, s, p, r: 1.0 - s.y**2), "below"],
            _on_surface,
        ),
        Switch(
            "up",
            "below",
            lambda t, s, p, r: -s.x,
            [("slides", lambda t, s, p, r: 1.0 - s.y**2), "above"],
            _on_surface,
        ),
        Switch("lifts", "slides", lambda t, s, p, r: 1.0 - s.y, "above"),
        Switch("sinks", "slides", lambda t, s, p, r: 1.0 + s.y, "below"),
    ],
    start={"x": 0.05, "y": -0.01, "z": 0.1, "regime": "above"},
)
"""Piiroinen and Kuznetsov's: on x = 0 the relay's mean output, −y, keeps the motion there."""


class Case(NamedTuple):
    """A system, its parameters, and what it is known to settle on.

    Attributes:
        settles: on so many periods, or returns to its section; 0 on none, as chaos; ``ANY``
            number that returns show, as after chaos that was not to last.
        family: of cycles of a conservative system.
        longest: step of DOP853, which sees two events in one step as none.
    """

    system: System
    parameters: dict
    settles: int
    start: dict | None = None
    family: bool = False
    longest: float = np.inf


ANY = -1


def _cases(system, name, values, settles, **options):
    """One parameter's values, and on how many periods each settles."""
    return [
        Case(system, {name: value}, number, **options)
        for value, number in zip(values, settles, strict=True)
    ]


CASES = [
    *_cases(
        duffing_holmes,
        "force",
        np.linspace(0.2, 0.6, 13),
        (1, 2, 0, ANY, 0, ANY, 0, 0, 0, 0, 0, ANY, 1),
    ),
    *_cases(ueda, "force", (0.5, 1.0, 2.0, 5.0, 7.5, 12.0), (1, 1, 1, 2, 3, 1)),
    # it turns over and over at 1.35 and 1.47, so that its angle never comes back
    *_cases(
        forced_pendulum, "force", (0.5, 0.9, 1.07, 1.15, 1.35, 1.47), (1, 1, 2, 0, 0, 0)
    ),
    *_cases(van_der_pol, "mu", (0.2, 1.0, 3.0, 8.0), (1, 1, 1, 1)),
    *_cases(brusselator, "b", (2.2, 3.0, 4.0), (1, 1, 1)),
    *_cases(fitzhugh_nagumo, "current", (0.4, 0.7, 1.0), (1, 1, 1)),
    *_cases(roessler, "c", (2.5, 3.5, 4.1, 5.7), (1, 1, 1, 0)),
    *_cases(lorenz, "r", (28.0, 160.0), (0, 1)),
    *_cases(lotka_volterra, "rate", (0.5, 1.0), (1, 1), family=True),
    *(
        Case(impact_oscillator, {"omega": 2.1, "amplitude": a}, number)
        for a, number in (
            (2.5, 1),
            (3.0, 1),
            (3.3, 1),
            (3.48, 0),
            (3.49, 16),
            (3.5, 2),
            (3.8, 1),
        )
    ),
    *_cases(buck, "supply", (18.0, 20.0, 23.0, 26.0, 30.0, 33.5), (1, 1, 1, 2, 2, 0)),
    *_cases(walker, "slope", (0.004, 0.009, 0.013), (1, 1, 1)),
    # from farther away it falls over
    Case(
        walker,
        {"slope": 0.0165},
        2,
        {"theta": 0.235, "phi": 0.47, "w": -0.235, "u": -0.0255},
    ),
    Case(relay, {"damping": 0.05}, 7, longest=4e-3),
    Case(relay, {"damping": 0.2}, 1),
]
"""Sixty-two. Without events every smooth cycle has one return."""
