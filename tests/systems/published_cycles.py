"""Published systems with cycles, and their return maps by SciPy."""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

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

CASES = [
    *((duffing_holmes, {"force": f}) for f in np.linspace(0.2, 0.6, 13)),
    *((ueda, {"force": f}) for f in (0.5, 1.0, 2.0, 5.0, 7.5, 12.0)),
    *((forced_pendulum, {"force": f}) for f in (0.5, 0.9, 1.07, 1.15, 1.35, 1.47)),
    *((van_der_pol, {"mu": mu}) for mu in (0.2, 1.0, 3.0, 8.0)),
    *((brusselator, {"b": b}) for b in (2.2, 3.0, 4.0)),
    *((fitzhugh_nagumo, {"current": c}) for c in (0.4, 0.7, 1.0)),
    *((roessler, {"c": c}) for c in (2.5, 3.5, 4.1, 5.7)),
    *((lorenz, {"r": r}) for r in (28.0, 160.0)),
    *((lotka_volterra, {"rate": r}) for r in (0.5, 1.0)),
    *((impact_oscillator, {"omega": 2.1, "amplitude": a}) for a in
      (2.5, 3.0, 3.3, 3.48, 3.49, 3.5, 3.8)),
    *((buck, {"supply": e}) for e in (18.0, 20.0, 23.0, 26.0, 30.0, 33.5)),
    *((walker, {"slope": s}) for s in (0.004, 0.009, 0.013, 0.0165)),
]  # fmt: skip
"""Systems and parameters: sixty."""


class Truth:
    """Runs of a system by DOP853, from the definition of its field, surfaces and resets."""

    def __init__(self, system, parameters):
        self.system = system
        self.parameters = SimpleNamespace(**{**system.parameters, **parameters})

    def at(self, t, state, regime):
        named = dict(zip(self.system.states, state, strict=True))
        constants = SimpleNamespace(**self.system.regimes[regime])
        return t, SimpleNamespace(**named), self.parameters, constants

    def rates(self, t, state, regime):
        rates = self.system.field(*self.at(t, state, regime))
        return [rates[name] for name in self.system.states]

    def after(self, state, regime, end):
        """The state at an instant."""
        t = 0.0
        while True:
            watched = [e for e in self.system.switches if regime in _several(e.leaves)]
            leg = solve_ivp(
                self.rates,
                (t, end),
                state,
                "DOP853",
                args=(regime,),
                events=[self._event(each) for each in watched] or None,
                rtol=1e-10,
                atol=1e-10 * self.system.sizes,
            )
            t, state = leg.t[-1], leg.y[:, -1]
            if leg.status != 1:
                return state
            which = next(i for i in range(len(watched)) if len(leg.t_events[i]))
            state, regime = self._switched(watched[which], t, state, regime)

    def _event(self, switch):
        def height(t, state, regime):
            return switch.when(*self.at(t, state, regime))

        height.terminal, height.direction = True, -1.0
        return height

    def _switched(self, switch, t, state, regime):
        before = self.at(t, state, regime)
        reset = switch.reset(*before) if switch.reset else {}
        names = zip(self.system.states, state, strict=True)
        after = np.array([reset.get(name, value) for name, value in names], float)
        for target in switch.to if isinstance(switch.to, list) else [switch.to]:
            name, *condition = _several(target)
            if not condition or condition[0](*before) >= 0.0:
                return after, name
        raise AssertionError("no target")


def _several(names):
    return (names,) if isinstance(names, str) else names
