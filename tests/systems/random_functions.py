"""Systems of all shipped functions from a generator, and their runs by another integrator.

The integrator is the method of Dormand and Prince of order 8 (coefficients from SciPy) in short
equal steps for all runs side by side. It sees a surface's inner function, not what is composed with
it, and brackets where that falls below zero.
"""

from types import SimpleNamespace

import numpy as np
from scipy.integrate._ivp import dop853_coefficients as dop853

from squealpipe import Switch, System
from squealpipe import functions as f

T_END = 6.0
STARTS = np.linspace(-0.9, 0.9, 10)
DRIVES = np.array([0.3, 0.6, 0.9, 1.2, 1.5])
NAMES = ("x", "v", "z")

BOUNDED = [
    f.sin,
    f.cos,
    f.tanh,
    f.atan,
    lambda u: f.asin(0.9 * f.sin(u)),
    lambda u: f.asin(0.8 * f.tanh(u)),
    lambda u: f.exp(-u * u),
    lambda u: 1.0 / f.cosh(u),
    lambda u: f.log(1.0 + u * u) / (1.0 + u * u),
    lambda u: u / f.sqrt(1.0 + u * u),
    lambda u: f.sinh(0.3 * u) / f.cosh(0.3 * u),
]
"""Terms of fields and outputs, which drive nothing to infinity."""


def monotone(rng):
    """A function that grows through zero."""
    w, k = float(rng.uniform(0.5, 8.0)), float(rng.choice([3, 5, 7]))
    outer = [
        lambda u: u,
        lambda u: u**k,
        lambda u: f.tanh(w * u),
        lambda u: f.atan(w * u),
        lambda u: f.asin(0.95 * f.tanh(u)),
        lambda u: f.sinh(0.5 * w * u),
        lambda u: f.exp(w * u) - 1.0,
        lambda u: u * f.cosh(0.2 * w * u),
        lambda u: u / f.sqrt(1.0 + w * u * u),
        lambda u: f.log(1.0 + f.exp(w * u)) - f.log(2.0 + 0.0 * u),
        lambda u: f.tanh(f.atan(u)) ** k,
    ][rng.integers(11)]
    scale = float(10.0 ** rng.choice([-150, -9, 0, 0, 9]))
    return lambda u: scale * outer(u)


def affine(rng):
    a, b, c = (float(each) for each in rng.normal(size=3))
    d = float(rng.uniform(0.1, 0.8))
    return lambda s: a * s.x + b * s.v + 0.5 * c * s.z + d


def bent(rng):
    a, b, c = (float(each) for each in rng.normal(size=3))
    d, w = float(rng.uniform(0.3, 0.9)), float(rng.uniform(1.0, 4.0))
    term = BOUNDED[rng.integers(len(BOUNDED))]
    return lambda s: a * s.x + 0.5 * b * s.v + 0.4 * c * term(w * s.x + s.z) + d


def random_functions(seed):
    """A system and the inner functions of its surfaces by name."""
    rng = np.random.default_rng(seed)
    first, second, third, fourth = (
        BOUNDED[i] for i in rng.integers(len(BOUNDED), size=4)
    )
    k, w, c = rng.uniform(0.5, 3.0), rng.uniform(0.5, 3.0), rng.uniform(0.05, 0.4)
    k, w, c = float(k), float(w), float(c)
    omega, push = float(rng.uniform(0.5, 2.5)), float(rng.uniform(-1.0, 1.0))
    turn = float(rng.uniform(0.3, 0.8))
    inner = {
        name: (bent if rng.random() < 0.5 else affine)(rng)
        for name in ("out", "back", "hit")
    }
    outer = {name: monotone(rng) for name in inner}
    out = inner["out"]
    inner["back"] = lambda s: 0.4 - out(s)  # so that there is a way back

    def field(t, s, p, r):
        return {
            "x": s.v,
            "v": -k * s.x
            - c * s.v
            - first(w * s.x)
            + p.drive * f.cos(omega * t)
            + r.push * second(s.z),
            "z": third(w * s.v) - s.z + 0.3 * r.push * fourth(s.x),
        }

    def when(name):
        return lambda t, s, p, r: outer[name](inner[name](s))

    system = System(
        f"functions {seed}",
        states=dict.fromkeys(NAMES, "1"),
        parameters={"drive": 1.0},
        regimes={"a": {"push": push}, "b": {"push": -0.7 * push}},
        field=field,
        switches=[
            Switch("out", "a", when("out"), "b"),
            Switch("back", "b", when("back"), "a"),
            Switch(
                "hit",
                "b",
                when("hit"),
                "a",
                reset=lambda t, s, p, r: {"v": -turn * s.v, "z": 0.5 * s.z},
            ),
        ],
        outputs={"seen": ("1", lambda t, s, p, r: first(2.0 * s.x) + third(s.v - s.z))},
        start={"x": 0.0, "v": 0.2, "z": 0.1, "regime": "a"},
        period=lambda p: 2.0 * np.pi / omega,
    )
    return system, inner


def _named(t, z):
    return t, SimpleNamespace(**dict(zip(NAMES, z, strict=True)))


class Lanes:
    """Runs side by side: states (3, runs), in regimes (runs,)."""

    MOST_AT_ONCE = 64

    def __init__(self, system, inner, starts, drives):
        self.system, self.inner = system, inner
        self.p = SimpleNamespace(drive=drives)
        self.push = np.array([each["push"] for each in system.regimes.values()])
        self.switches = sorted(system.switches, key=lambda each: each.name)
        size = len(starts)
        self.z = np.array([starts, np.full(size, 0.2), np.full(size, 0.1)])
        self.t, self.regime = np.zeros(size), np.zeros(size, int)
        self.counts = {each.name: np.zeros(size, int) for each in self.switches}
        self.firsts = {each.name: np.full(size, np.nan) for each in self.switches}
        self.lowest, self.highest = np.full(size, np.inf), np.full(size, -np.inf)
        self.unclear, self.trapped = np.zeros(size, bool), np.zeros(size, bool)
        self.margin = np.full(size, np.inf)

    def rates(self, t, z, rows):
        p = SimpleNamespace(drive=self.p.drive[rows])
        r = SimpleNamespace(push=self.push[self.regime[rows]])
        found = self.system.field(*_named(t, z), p, r)
        return np.array([found[name] + 0.0 * z[0] for name in NAMES])

    def step(self, h, rows):
        """States of some runs after a step."""
        t, z, stages = self.t[rows], self.z[:, rows], []
        for c, row in zip(dop853.C[: dop853.N_STAGES], dop853.A, strict=False):
            moved = sum(
                (a * k for a, k in zip(row, stages, strict=False) if a),
                np.zeros_like(z),
            )
            stages.append(self.rates(t + c * h, z + h * moved, rows))
        return z + h * sum(b * k for b, k in zip(dop853.B, stages, strict=True))

    def heights(self, z, rows):
        """(switches, runs): infinite of what is not watched."""
        _, s = _named(0.0, z)
        names = list(self.system.regimes)
        regime = np.array(names)[self.regime[rows]]
        return np.array(
            [
                np.where(regime == each.leaves, self.inner[each.name](s), np.inf)
                for each in self.switches
            ]
        )

    def fire(self, rows, which):
        for number, switch in enumerate(self.switches):
            mine = rows[which == number]
            self.counts[switch.name][mine] += 1
            firsts = self.firsts[switch.name]
            firsts[mine] = np.where(np.isnan(firsts[mine]), self.t[mine], firsts[mine])
            if switch.reset:
                t, s = _named(self.t[mine], self.z[:, mine])
                for name, value in switch.reset(t, s, None, None).items():
                    self.z[NAMES.index(name), mine] = value
            self.regime[mine] = list(self.system.regimes).index(switch.to)

    def at_once(self, rows):
        """Fire what is beyond zero, in order of names; some runs do so for ever."""
        for _ in range(self.MOST_AT_ONCE):
            heights = self.heights(self.z[:, rows], rows)
            self.margin[rows] = np.minimum(
                self.margin[rows], np.abs(heights).min(axis=0, initial=np.inf)
            )
            beyond = (heights < -1e-11).any(axis=0)
            if not beyond.any():
                return
            rows = rows[beyond]
            self.fire(rows, np.argmax(heights[:, beyond] < -1e-11, axis=0))
        self.trapped[rows] = True

    def run(self, h):
        every = np.arange(self.z.shape[1])
        self.see(every)
        self.at_once(every)
        self.see(every)
        while (self.t < T_END).any():
            rows = np.flatnonzero((self.t < T_END) & ~self.trapped)
            if not rows.size:
                break
            left = np.minimum(h, T_END - self.t[rows])
            before = self.heights(self.z[:, rows], rows)
            after = self.step(left, rows)
            heights = self.heights(after, rows)
            falls = (before > -1e-11) & (heights < 0.0)
            hit = falls.any(axis=0)
            calm = rows[~hit]
            self.z[:, calm] = after[:, ~hit]
            self.t[calm] += left[~hit]
            self.t[calm[left[~hit] < h]] = T_END
            if hit.any():
                self.cut(rows[hit], left[hit], falls[:, hit])
            self.see(every)
        return self

    def see(self, rows):
        """Note the output of some runs."""
        t, s = _named(self.t[rows], self.z[:, rows])
        (_, seen) = next(iter(self.system.outputs.values()))
        value = seen(t, s, None, None)
        self.lowest[rows] = np.minimum(self.lowest[rows], value)
        self.highest[rows] = np.maximum(self.highest[rows], value)

    def cut(self, rows, h, falls):
        """Go on to the first crossing of some runs and carry it out."""
        low, high = np.zeros_like(h), h.copy()
        for _ in range(60):
            middle = 0.5 * (low + high)
            heights = self.heights(self.step(middle, rows), rows)
            below = (falls & (heights < 0.0)).any(axis=0)
            low, high = np.where(below, low, middle), np.where(below, middle, high)
        end = self.step(high, rows)
        heights = np.where(falls, self.heights(end, rows), np.inf)
        self.z[:, rows] = end
        self.t[rows] += high
        self.see(rows)
        self.fire(rows, np.argmin(heights, axis=0))
        self.at_once(rows)
