"""The problems as systems; ``python -m tests.benchmark.make_problems`` writes ``problems.yaml``."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import yaml

import squealpipe
from squealpipe.benchmark.problems import SHARED
from squealpipe.functions import cos, sin
from squealpipe.methods.taylor.symbols import parameter, substituted, symbol
from squealpipe.parameters import Parameters
from squealpipe.systems.belt_friction import leine_oscillator
from squealpipe.systems.bouncing_ball import bouncing_ball
from squealpipe.systems.brake import brake, parameters_of_run
from squealpipe.systems.dry_friction import dry_friction_oscillator
from squealpipe.systems.impact_oscillator import impact_oscillator
from squealpipe.systems.relief_valve import relief_valve
from squealpipe.systems.system import Switch, System
from squealpipe.systems.text import expression
from squealpipe.systems.trace import TIME, TIME_UNIT

FILE = Path(squealpipe.__file__).parent / "benchmark/problems.yaml"
Changes = Mapping[str, Any]


@dataclass(frozen=True)
class Case:
    """A system with a start and a time.

    Attributes:
        name, group, purpose: of the problem.
        system: what moves.
        t_end: until when.
        changed: parameters that differ from the system's.
        start: states that differ from the system's start.
        more: further entries of the data: times, derivative, smoothed, stepping.
    """

    name: str
    group: str
    purpose: str
    system: System
    t_end: float
    changed: Changes = field(default_factory=dict)
    start: Changes = field(default_factory=dict)
    more: Changes = field(default_factory=dict)

    def data(self):
        """The problem as plain data, its equations those of the traced system."""
        system, traced = self.system, self.system.traced
        unit = {id(parameter(TIME_UNIT)): symbol(1.0)}
        values = {**system.parameters, **self.changed}
        start = {name: float(self.start.get(name, system.start[name])) for name in system.states}
        given = {key: np.array([v]) for key, v in {**values, **start, TIME: 0.0}.items()}

        def text(root):
            return None if root is None else expression(substituted(root, unit))

        switches = [
            {
                "name": switch.name,
                "leaves": [switch.leaves]
                if isinstance(switch.leaves, str)
                else list(switch.leaves),
                "when": text(symbols.surface),
                "to": [
                    [system.states_of(regime), text(condition), traced.kinds[kind]]
                    for regime, condition, kind in symbols.targets
                ],
                "reset": {system.states[i]: text(value) for i, value in symbols.reset.items()},
            }
            for switch, symbols in zip(system.switches, traced.switches, strict=True)
        ]
        rates = {n: text(r) for n, r in zip(system.states, traced.rates, strict=False)}
        used = set(re.findall(r"\w+", str((rates, switches, self.more))))
        return {
            "name": self.name,
            "class": self.group,
            "purpose": self.purpose,
            "start": start,
            "regime": system.states_of(int(system.first_regimes(given, 1)[0])),
            "t_end": float(self.t_end),
            "times": [],
            "parameters": {name: float(v) for name, v in values.items() if name in used},
            "regimes": {
                name: {key: float(v) for key, v in constants.items()}
                for name, constants in system.regimes.items()
            },
            "field": rates,
            "switches": switches,
            **self.more,
        }


def barrier(name, rates, parameters, x):
    """States x and v; the events are the passages of x through the parameter ``level``."""
    return System(
        name,
        states={"x": "1", "v": "1"},
        parameters=parameters,
        regimes={"below": {"above": 0.0}, "above": {"above": 1.0}},
        field=lambda t, s, p, r: rates(s, p),
        switches=[
            Switch("up", "below", lambda t, s, p, r: p.level - s.x, "above"),
            Switch("down", "above", lambda t, s, p, r: s.x - p.level, "below"),
        ],
        start={"x": x, "v": 1.0},
    )


def _fall(s, p):
    return {"x": s.v, "v": -p.gravity}


harmonic = barrier("oscillator", lambda s, p: {"x": s.v, "v": -s.x}, {"level": 0.5}, 0.0)
thrown = barrier("thrown ball at a light barrier", _fall, {"level": 0.49, "gravity": 1.0}, 0.0)
van_der_pol = barrier(
    "van der Pol's oscillator",
    lambda s, p: {"x": s.v, "v": p.stiffness * (1.0 - s.x * s.x) * s.v - s.x},
    {"level": 1.0, "stiffness": 20.0},
    0.0,
)
thermostat = System(
    "thermostat",
    states={"x": "K"},
    parameters={"high": 1.0, "low": 0.5, "heat": 2.0},
    regimes={"on": {"on": 1.0}, "off": {"on": 0.0}},
    field=lambda t, s, p, r: {"x": r.on * p.heat - s.x},
    switches=[
        Switch("too_warm", "on", lambda t, s, p, r: p.high - s.x, "off"),
        Switch("too_cold", "off", lambda t, s, p, r: s.x - p.low, "on"),
    ],
    start={"x": 0.0},
)
gates = System(
    "ball that falls through two gates",
    states={"x": "1", "v": "1"},
    parameters={"first": 0.5, "second": 0.499, "gravity": 1.0},
    regimes={
        "above": {"seen": 0.0},
        "first_seen": {"seen": 1.0},
        "second_seen": {"seen": -1.0},
        "below": {"seen": 0.0},
    },
    field=lambda t, s, p, r: _fall(s, p),
    switches=[
        # the names put the later one first
        Switch(
            "a_second", ("above", "first_seen"), lambda t, s, p, r: s.x - p.second,
            [("below", lambda t, s, p, r: r.seen - 0.5, "a_second"), "second_seen"],
        ),
        Switch(
            "b_first", ("above", "second_seen"), lambda t, s, p, r: s.x - p.first,
            [("below", lambda t, s, p, r: -r.seen - 0.5, "b_first"), "first_seen"],
        ),
    ],
    start={"x": 1.0, "v": 0.0},
)  # fmt: skip
two_balls = System(
    "two balls",
    states={"x1": "1", "v1": "1", "x2": "1", "v2": "1"},
    parameters={"gravity": 1.0, "restitution1": 0.75, "restitution2": 0.5},
    regimes={"free": {}},
    field=lambda t, s, p, r: {"x1": s.v1, "v1": -p.gravity, "x2": s.v2, "v2": -p.gravity},
    switches=[
        Switch(
            "impact1", "free", lambda t, s, p, r: s.x1, "free",
            lambda t, s, p, r: {"v1": -p.restitution1 * s.v1},
        ),
        Switch(
            "impact2", "free", lambda t, s, p, r: s.x2, "free",
            lambda t, s, p, r: {"v2": -p.restitution2 * s.v2},
        ),
    ],
    start={"x1": 1.0, "v1": 0.0, "x2": 1.0, "v2": 0.0},
)  # fmt: skip


def _table(t, p):
    return p.amplitude * sin(t)


shaken_table = System(
    "mass on a shaken table",
    states={"x": "1", "v": "1"},
    parameters={"amplitude": 1.5, "gravity": 1.0},
    regimes={"contact": {"kept": 1.0}, "flight": {"kept": 0.0}},
    field=lambda t, s, p, r: {
        "x": s.v,
        "v": -r.kept * _table(t, p) - (1.0 - r.kept) * p.gravity,
    },
    switches=[
        Switch("release", "contact", lambda t, s, p, r: p.gravity - _table(t, p), "flight"),
        Switch(
            "landing", "flight", lambda t, s, p, r: s.x - _table(t, p), "contact",
            lambda t, s, p, r: {"x": _table(t, p), "v": p.amplitude * cos(t)},
        ),
    ],
    start={"x": 0.0, "v": 1.5},
)  # fmt: skip
long_flight = System(
    "ball on a stiff spring",
    states={"x": "1", "v": "1"},
    parameters={"gravity": 1.0, "stiffness": 1e6},
    regimes={"flight": {"contact": 0.0}, "contact": {"contact": 1.0}},
    field=lambda t, s, p, r: {"x": s.v, "v": -p.gravity - r.contact * p.stiffness * s.x},
    switches=[
        Switch("landing", "flight", lambda t, s, p, r: s.x, "contact"),
        Switch("release", "contact", lambda t, s, p, r: -s.x, "flight"),
    ],
    start={"x": 0.0, "v": 100.0, "regime": "flight"},
)

BASE = Parameters(k3=0.75, mu=0.3, belt_speed=100.0, length1=5.0, length2=5.0)
"""Parameters of the brake at which its scenes are hard; m = k1 = l_pre = 1."""
GRAZING_K3 = 0.9574533446362244
"""1e-8 above the contact stiffness at which the mass just takes off at its first peak."""
PIVOT = (-1.4999999999999996, 4.330127019922193)
"""Where the mass starts 4 left of the pivot of the first spring, and 1e-9 above it."""
_SMOOTH = {
    "contact": "(0.5 + 0.5 * tanh(sigma * (preload - y)))",
    "direction": "tanh(sigma * (belt_speed - vx))",
    "stick": "0.0",
}
_STEPPING = {
    "velocities": ["vx", "vy"],
    "constants": {"contact": "float(y < preload)", "direction": "0.0", "stick": "0.0"},
    "friction": ["vx", "belt_speed", "mu * k3 * max(preload - y, 0.0) / mass"],
}


def impact(velocity, gap, restitution):
    """What Moreau–Jean stepping needs of a system with one stop."""
    stop = [velocity, gap, restitution]
    return {"stepping": {"velocities": [velocity], "constants": {}, "impact": stop}}


def a1(
    name, group, purpose, angles, t_end,
    start = (0.0, 0.0, 0.0, 0.0), more = MappingProxyType({}),
    **changed,
):  # fmt: skip
    """A scene of the brake pad A1, angles over π."""
    values = parameters_of_run(BASE.with_(**changed), angles[0] * pi, angles[1] * pi)
    states = dict(zip(("x", "y", "vx", "vy"), start, strict=True))
    more = {"smoothed": _SMOOTH, "stepping": _STEPPING, **more}
    return Case(f"A1: {name}", group, purpose, brake(), t_end, values, states, more)


def tangency(distance, purpose):
    """An oscillator of amplitude 1 whose barrier is at 1 − distance."""
    where = f"tangency, depth {distance:g}" if distance > 0 else "near miss"
    return Case(where, "tangency", purpose, harmonic, 12.0, {"level": 1.0 - distance})


_STOP = impact("v", "gap - x", "restitution")
_PAIR = "two crossings that close in on one another: both or none"
CASES = (
    Case(
        "bouncing ball", "transversal", "impacts with closed-form times, ever faster",
        bouncing_ball, 26.0, {"gravity": 1.0, "restitution": 0.9}, {"y": 1.0, "v": 0.0},
        impact("v", "y", "restitution"),
    ),
    Case(
        "thermostat", "transversal", "two switches that undo one another; up and down not mixed up",
        thermostat, 10.0,
    ),
    Case(
        "relief valve", "transversal", "impacts of a published stiff, nonlinear system",
        relief_valve, 10.0, {"q": 3.0}, {"y1": 1.0, "y2": 0.0, "y3": 11.0},
        impact("y2", "y1", "restitution"),
    ),
    Case(
        "relaxation", "transversal", "van der Pol's jumps: steps are rejected at the crossings",
        van_der_pol, 60.0,
    ),
    Case(
        "light barrier", "pair in a step", "a polynomial motion whose step spans both crossings",
        thrown, 1.9,
    ),
    tangency(1e-3, _PAIR),
    tangency(1e-6, _PAIR),
    tangency(1e-9, _PAIR),
    tangency(1e-14, "as before, known only to the tightest tolerances"),
    tangency(-1e-3, "a surface that is almost reached: no event"),
    Case(
        "two gates", "order", "two crossings in a step, the later one first in the list",
        gates, 1.3,
    ),
    Case(
        "two balls", "simultaneous", "two surfaces reached at once; neither ball may fall through",
        two_balls, 3.8,
    ),
    Case(
        "saved instants", "start and output", "impacts exactly where output is asked for",
        bouncing_ball, 6.0, {"gravity": 1.0, "restitution": 1.0}, {"y": 0.5, "v": 0.0},
        {"times": [1.0, 2.0, 3.0, 4.0, 5.0], **impact("v", "y", "restitution")},
    ),
    Case(
        "start on the surface", "start and output", "no event at t = 0, the first one later",
        bouncing_ball, 5.0, {"gravity": 1.0, "restitution": 0.75}, {"y": 0.0, "v": 1.0},
        impact("v", "y", "restitution"),
    ),
    Case(
        "dry friction", "stick", "it sticks with v = 0 exactly, and is released",
        dry_friction_oscillator, 40.0, {"omega": 0.4}, {},
        {
            "smoothed": {"direction": "tanh(sigma * v)", "slips": "1.0"},
            "stepping": {
                "velocities": ["v"],
                "constants": {"direction": "0.0", "slips": "1.0"},
                "friction": ["v", "0.0", "1.0"],
            },
        },
    ),
    Case(
        "stick–slip", "stick", "Leine's oscillator on its belt",
        leine_oscillator, 40.0, {}, {"x": 0.5},
        {"smoothed": {"direction": "tanh(sigma * (belt_speed - v))", "stick": "0.0"}},
    ),
    Case(
        "shaken table", "kept contact", "a gap that stays zero; flight leaves it tangentially",
        shaken_table, 40.0,
    ),
    Case(
        "chattering", "accumulation", "infinitely many impacts before the end: a flag is right",
        bouncing_ball, 10.0, {"gravity": 1.0, "restitution": 0.5}, {"y": 1.0, "v": 0.0},
        {"unknowable": "its events accumulate at t = 3 √2", **impact("v", "y", "restitution")},
    ),
    Case(
        "long flight", "long flight", "contacts of π/1000 between flights of 200",
        long_flight, 1000.0,
    ),
    Case(
        "chaotic impacts", "chaos", "an impact oscillator whose errors grow",
        impact_oscillator, 60.0, {"amplitude": 4.0, "omega": 2.27}, {}, _STOP,
    ),
    Case(
        "time of the third impact", "derivative", "and its derivative by the gap",
        impact_oscillator, 20.0, {"amplitude": 0.8, "omega": 1.2}, {},
        {"derivative": [2, "gap"], **_STOP},
    ),
    a1("hammering", "transversal", "the brake pad loses contact again and again", (1.0, 1.0), 30.0),
    a1("grazing contact", "tangency", "it leaves by a hair", (0.5, 1.0), 4.0, k3=GRAZING_K3),
    a1(
        "separation in stick", "stick", "contact lost in stick, and friction with it",
        (0.95, 0.95), 9.0, more={"tie": "where contact ends, so does friction"}, belt_speed=0,
    ),
    a1("stick release", "stick", "on a slow disc", (0.3, 0.9), 30.0, belt_speed=0.05),
    a1(
        "simultaneous events", "simultaneous", "it starts on two surfaces", (0.3, 0.9), 20.0,
        (0.0, 1.0, 0.5, -0.5), {"regime": "slip_slower"}, belt_speed=0.5,
    ),
    a1(
        "near-pivot passage", "stiff", "it passes a pivot at 1e-9", (1 / 3, 0.9), 2.0,
        (PIVOT[0], PIVOT[1], 8.0, 0.0),
    ),
    a1(
        "very stiff contact", "stiff", "contacts a thousand times shorter than the flights",
        (0.5, 1.0), 20.0, (0.0, 1.1, 0.0, 0.0), k3=1e6,
    ),
    a1("chaotic hammering", "chaos", "errors grow a million times", (0.2, 0.8), 200.0),
    a1(
        "beyond the horizon", "chaos", "errors outgrow every double: a flag is right", (0.2, 0.8),
        600.0, more={"unknowable": "errors grow by more than 1e16"},
    ),
)  # fmt: skip


def entries():
    """All problems as plain data; equations that an earlier one has are given by its name."""
    found: list[dict[str, Any]] = []
    for case in CASES:
        mine = case.data()
        for other in found:
            if all(mine.get(key) == other.get(key) for key in SHARED):
                mine = {"name": mine["name"], "system": other["name"]} | mine
                mine = {key: value for key, value in mine.items() if key not in SHARED}
                break
        found.append(mine)
    return found


def main():
    """Write ``problems.yaml``."""
    style: dict[str, Any] = {
        "sort_keys": False,
        "allow_unicode": True,
        "width": 1000,
        "default_flow_style": None,
    }
    FILE.write_text(yaml.safe_dump(entries(), **style), "utf-8")


if __name__ == "__main__":
    main()
