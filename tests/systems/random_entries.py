"""Random systems whose regimes are entered beyond their surfaces, and their runs by DOP853."""

import re
from collections import Counter
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

from squealpipe import Component, Switch, System
from squealpipe.functions import cos, sin, tanh

T_END, MOST_EVENTS, MOST_AT_ONCE = 6.0, 40, 64
NEAR_ZERO = 1e-9
LEVEL = 0.25
"""Where some surfaces are, and where some resets lead exactly."""


def height(rng, names, others):
    """A surface: of one state, or bent, and lifted by the regime or another component's."""
    if rng.random() < 0.3:
        place = int(rng.integers(len(names)))
        name, sign = names[place], (-1.0) ** place
        return lambda t, s, p, r: sign * (getattr(s, name) - LEVEL)
    weights = [float(w) for w in rng.normal(size=len(names))]
    bend, lift, level, swing = (float(w) for w in rng.normal(size=4))
    steep = float(rng.uniform(0.5, 3.0))

    def surface(t, s, p, r):
        total = sum(w * getattr(s, n) for w, n in zip(weights, names, strict=True))
        lifted = sum(getattr(r, other).lift for other in others) if others else r.lift
        return (
            total
            + 0.4 * bend * tanh(steep * getattr(s, names[0]))
            + 0.6 * lift * lifted
            + 0.3 * level
            + 0.1 * swing * sin(2.0 * t)
        )

    return surface


def reset(rng, names):
    """A jump of one state: back by a share, or to the very surface of others."""
    name = str(rng.choice(names))
    if rng.random() < 0.4:
        return lambda t, s, p, r: {name: LEVEL}
    share, shift = float(rng.uniform(-0.9, -0.3)), float(rng.normal())
    return lambda t, s, p, r: {name: share * getattr(s, name) + 0.3 * shift}


def switches_between(rng, regimes, names, others):
    """Some switches, whose names are not in the order of their definition."""
    switches = []
    for name in rng.permutation(list("abcdef"))[: len(regimes) + 1]:
        count = 2 if rng.random() < 0.2 else 1
        leaves = tuple(str(n) for n in rng.permutation(regimes)[:count])
        to = str(rng.choice(regimes))
        if rng.random() < 0.5:
            first = str(rng.choice(regimes))
            to = [(first, height(rng, names, others), f"{name}_to_{first}"), to]
        jumps = reset(rng, names) if rng.random() < 0.5 else None
        switches.append(
            Switch(str(name), leaves, height(rng, names, others), to, jumps)
        )
    return switches


def drawn(rng, with_components):
    """A definition, which may be refused."""
    names = [f"x{i}" for i in range(int(rng.integers(2, 5)))]
    part = rng.normal(size=(len(names), len(names)))
    matrix = (part - part.T - 0.3 * np.eye(len(names))).tolist()
    pushes = rng.normal(size=len(names)).tolist()
    owners = ["left", "right"] if with_components else [""]

    def rates(t, s, p, r):
        values = [getattr(s, name) for name in names]
        parts = [getattr(r, owner) for owner in owners] if with_components else [r]
        push = sum(part.push for part in parts)
        return {
            name: sum(a * v for a, v in zip(row, values, strict=True))
            + f * (push + p.drive * cos(1.3 * t))
            - 0.2 * tanh(2.0 * values[i])
            for i, (name, row, f) in enumerate(zip(names, matrix, pushes, strict=True))
        }

    def regimes():
        numbers = range(int(rng.integers(2, 5)))
        return {
            f"r{i}": {"push": float(rng.normal()), "lift": float(rng.normal())}
            for i in numbers
        }

    parts = {owner: regimes() for owner in owners}
    switches = {
        owner: switches_between(
            rng, list(parts[owner]), names, with_components and owners
        )
        for owner in owners
    }
    if with_components:
        own = {
            "components": {
                owner: Component(parts[owner], switches[owner], ["r0"])
                for owner in owners
            }
        }
    else:
        own = {"regimes": parts[""], "switches": switches[""]}
    system = System(
        "entries",
        states=dict.fromkeys(names, "1"),
        parameters={"drive": 0.5},
        field=rates,
        start=dict.fromkeys(names, 0.0),
        **own,
    )
    return Drawn(system, names, rates, parts, switches)


@dataclass
class Drawn:
    """A system and what it was made of: regimes and switches of each component."""

    system: System
    names: list
    rates: object
    parts: dict
    switches: dict

    def run(self, start, regimes, step):
        return Run(self, np.array(start), dict(regimes), step).to_the_end()


def random_entries(seed):
    """Systems without end; for every third seed of two components."""
    rng = np.random.default_rng(seed)
    while True:
        try:
            yield drawn(rng, seed % 3 == 2)
        except (
            ValueError
        ) as error:  # it would never end, or one surface has two switches
            if not re.search("fire again at once|same surface", str(error)):
                raise


@dataclass
class Run:
    """A run of a drawn system, event by event."""

    of: Drawn
    z: np.ndarray
    regimes: dict
    step: float
    t: float = 0.0
    events: list = field(default_factory=list)
    causes: Counter = field(default_factory=Counter)
    led_here: tuple = ()
    trapped: bool = False
    unclear: bool = False

    def at(self, t, z):
        """What the system's functions see."""
        states = SimpleNamespace(**dict(zip(self.of.names, z, strict=True)))
        constants = {
            owner: SimpleNamespace(**self.of.parts[owner][regime])
            for owner, regime in self.regimes.items()
        }
        seen = constants.get("") or SimpleNamespace(**constants)
        return t, states, SimpleNamespace(drive=0.5), seen

    def slope(self, t, z):
        return np.array(list(self.of.rates(*self.at(t, z)).values()))

    def watched(self):
        """(component, switch) in the order in which they go."""
        return [
            (owner, switch)
            for owner, switches in self.of.switches.items()
            for switch in sorted(switches, key=lambda switch: switch.name)
            if self.regimes[owner] in switch.leaves
        ]

    def marks(self, owner, switch):
        """Whether it changes nothing in this regime, so that nothing is beyond its surface."""
        targets = [switch.to] if isinstance(switch.to, str) else switch.to
        names = {target if isinstance(target, str) else target[0] for target in targets}
        return names == {self.regimes[owner]} and switch.reset is None

    def beyond(self, last):
        """The first switch whose surface is below zero, or at zero and falls."""
        ahead = 1e-6
        later = self.z + ahead * self.slope(self.t, self.z)
        for owner, switch in self.watched():
            if self.marks(owner, switch):
                continue
            here = switch.when(*self.at(self.t, self.z))
            if abs(here) > NEAR_ZERO:
                if here < 0.0:
                    return owner, switch
                continue
            slope = (switch.when(*self.at(self.t + ahead, later)) - here) / ahead
            self.unclear |= abs(slope) < 1e-4
            self.unclear |= here != 0.0 and (owner, switch) not in last
            if slope < 0.0:
                return owner, switch
        return None

    def fire(self, owner, switch):
        before = self.at(self.t, self.z)
        regime, kind = switch.to, switch.name
        if not isinstance(switch.to, str):
            (first, condition, renamed), last = switch.to
            value = condition(*before)
            self.unclear |= abs(value) < NEAR_ZERO
            regime, kind = (first, renamed) if value >= 0.0 else (last, kind)
        if switch.reset is not None:
            for name, value in switch.reset(*before).items():
                self.z[self.of.names.index(name)] = value
        self.regimes[owner], self.led_here = regime, (owner, switch)
        prefix = f"{owner}_" if owner else ""
        self.events.append((self.t, prefix + kind, prefix + regime))

    def at_once(self, last):
        """Carry out what was entered beyond; ``causes`` counts what led there."""
        number = 0
        while (which := self.beyond(last)) is not None:
            if number == MOST_AT_ONCE:
                self.trapped = True
                return
            self.causes[self.cause(which)] += 1
            self.fire(*which)
            last, number = [*last, which], number + 1

    def cause(self, which):
        if not self.events:
            return "start"
        owner, switch = self.led_here
        if owner != which[0]:
            return "component"
        if switch.reset is not None:
            return "reset"
        return "switch" if isinstance(switch.to, str) else "target"

    def to_the_end(self):
        self.at_once([])
        while not self.trapped and len(self.events) < MOST_EVENTS:
            watched = self.watched()
            leg = solve_ivp(
                self.slope,
                (self.t, T_END),
                self.z,
                "DOP853",
                rtol=1e-12,
                atol=1e-12,
                max_step=self.step,
                events=[self.guard(*each) for each in watched],
            )
            self.t, self.z = float(leg.t[-1]), leg.y[:, -1].copy()
            if leg.status != 1:
                break
            hits = [k for k, times in enumerate(leg.t_events) if len(times)]
            self.unclear |= len(hits) > 1
            self.fire(*watched[hits[0]])
            self.at_once([self.led_here])
        return self

    def guard(self, owner, switch):
        """Of a leg that begins now: a marker that begins at zero has to rise first."""
        begin = self.t
        starts_at_zero = abs(switch.when(*self.at(begin, self.z))) < NEAR_ZERO
        waits = begin + 1e-6 if starts_at_zero and self.marks(owner, switch) else begin

        def value(t, z):
            return -1.0 if t < waits else switch.when(*self.at(t, z))

        value.terminal, value.direction = True, -1.0
        return value
