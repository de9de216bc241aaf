"""Answers where friction falls with speed or stick has a limit of its own; shares no code.

Friction that depends on speed makes slip nonlinear: runs take steps of the fifth order (Dormand and
Prince), and an event is located by repeating its step with shorter lengths.
"""

from typing import Any, NamedTuple

import numba
import numpy as np
import scipy.linalg as la

from tests.oracles.many_contacts import OPEN
from tests.oracles.structure_answers import Motion

COULOMB, EXPONENTIAL, HYPERBOLIC, TABLE = range(4)
STEPS = 24
"""Steps in a period of the fastest mode."""
KNOTS = 8
"""Most knots of a table."""
STAGES = np.array(
    [
        [0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
    ]
)
WEIGHTS = np.array([35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])


class Numbers(NamedTuple):
    """Arrays that the compiled functions read."""

    load: Any
    stiffness: Any
    damping: Any
    n: Any
    t: Any
    from_n: Any
    from_t: Any
    mobility: Any
    belt: Any
    pressed: Any
    springs: Any
    laws: Any
    knots: Any
    scale: Any
    stages: Any
    weights: Any


def table_of(text):
    """Abscissae and values of a table, and the slope behind each."""
    at, value = np.array([pair.split(":") for pair in text.split()[1:]], float).T
    return at, value, np.append(np.diff(value) / np.diff(at), 0.0)


def law_of(friction):
    """Kind, coefficient at high speed, its excess at speed 0, speed of the fall, limit; knots."""
    knots = np.full((3, KNOTS), np.inf)
    name, mu, limit = friction.friction_law, friction.mu, friction.mu_static
    if name.startswith("linear"):
        at, value, slope = table_of(name)
        knots[:, : len(at)] = at, mu * value, mu * slope
        onset = mu * value[0]
        return (TABLE, 0.0, 0.0, 1.0, onset if limit is None else limit), knots
    kind = ("coulomb", "exponential", "hyperbolic").index(name)
    limit = mu if limit is None else limit
    return (kind, mu, limit - mu, friction.friction_speed, limit), knots


@numba.njit(cache=True)
def piece(at, knots):
    last = 0
    while last + 1 < KNOTS and knots[0, last + 1] <= at:
        last += 1
    return last


@numba.njit(cache=True)
def coefficient(speed, law, knots):
    """μ and its slope; beyond speed 0 it goes on straight."""
    if law[0] == COULOMB:
        return law[1], 0.0
    forward = max(speed, 0.0)
    if law[0] == EXPONENTIAL:
        fall = law[2] * np.exp(-forward / law[3])
        slope = -fall / law[3]
        return law[1] + fall + slope * (speed - forward), slope
    if law[0] == HYPERBOLIC:
        share = law[3] / (law[3] + forward)
        slope = -law[2] * share * share / law[3]
        return law[1] + law[2] * share + slope * (speed - forward), slope
    last = piece(speed, knots)
    return knots[1, last] + knots[2, last] * (speed - knots[0, last]), knots[2, last]


@numba.njit(cache=True)
def forces(z, sides, s):
    """Acceleration; normal force, lag behind the belt and friction of each contact."""
    size, count = len(z) // 2, len(sides)
    normal, lag, drag = np.zeros(count), np.zeros(count), np.zeros(count)
    a = s.load - s.stiffness @ z[:size] - s.damping @ z[size:]
    for i in range(count):
        pressed, lag[i] = s.pressed[i], s.belt[i]
        for j in range(size):
            pressed -= s.n[j, i] * z[j]
            lag[i] -= s.t[j, i] * z[size + j]
        last = piece(pressed, s.springs[i])
        knots = s.springs[i]
        normal[i] = knots[1, last] + knots[2, last] * (pressed - knots[0, last])
        if sides[i] != OPEN:
            if sides[i]:
                mu, _ = coefficient(sides[i] * lag[i], s.laws[i], s.knots[i])
                drag[i] = sides[i] * mu * normal[i]
            a += s.from_n[:, i] * normal[i] + s.from_t[:, i] * drag[i]
    stuck = np.flatnonzero(sides == 0)
    if len(stuck):
        held = np.linalg.solve(s.mobility[stuck][:, stuck], -(s.t.T[stuck] @ a))
        drag[stuck] = held
        a += s.from_t[:, stuck] @ held
    return a, normal, lag, drag


@numba.njit(cache=True)
def stepped(z, h, sides, s):
    size = len(z) // 2
    k = np.zeros((6, len(z)))
    for stage in range(6):
        at = z.copy()
        for before in range(stage):
            at += h * s.stages[stage, before] * k[before]
        k[stage, :size] = at[size:]
        k[stage, size:] = forces(at, sides, s)[0]
    return z + h * (s.weights @ k)


@numba.njit(cache=True)
def heights(z, sides, s):
    """Return what has to stay positive: two numbers a contact."""
    _, normal, lag, drag = forces(z, sides, s)
    for i in range(len(sides)):
        if sides[i] == OPEN:
            normal[i], drag[i] = -normal[i], np.inf
        elif sides[i]:
            drag[i] = sides[i] * lag[i]
        else:
            drag[i] = s.laws[i, 4] * normal[i] - abs(drag[i])
    return np.concatenate((normal, drag))


@numba.njit(cache=True)
def changed(z, sides, which, s):
    """Carry out one event."""
    count, size = len(sides), len(z) // 2
    i = which % count
    _, normal, lag, drag = forces(z, sides, s)
    if which < count:
        sides[i] = (1 if lag[i] > 0 else -1) if sides[i] == OPEN else OPEN
    elif sides[i] == 0:
        sides[i] = 1 if drag[i] > 0 else -1
    else:
        z[size:] += s.from_t[:, i] * lag[i] / s.mobility[i, i]
        before, sides[i] = sides[i], 0
        _, normal, _, drag = forces(z, sides, s)
        if abs(drag[i]) > s.laws[i, 4] * normal[i]:
            sides[i] = -before


@numba.njit(cache=True)
def located(z, high, which, start, end, sides, s):
    """Return when one height, which is below zero after a step, falls through it."""
    low, least, step, last = 0.0, 1e-10 * s.scale[which], high, 0
    if start < least:  # it leaves zero first
        low = high
        for _ in range(30):
            low *= 0.5
            start = heights(stepped(z, low, sides, s), sides, s)[which]
            if start > 0.0:
                break
        if start <= 0.0:
            return 0.0
    reached = end
    for _ in range(100):
        if high - low < 1e-12 * step or reached > -0.1 * least:
            break
        # false position; the end that stays counts half (Illinois)
        middle = low + (high - low) * start / (start - end)
        height = heights(stepped(z, middle, sides, s), sides, s)[which]
        if height > 0.0:
            low, start = middle, height
            end *= 0.5 if last == 1 else 1.0
            last = 1
        else:
            high, end, reached = middle, height, height
            start *= 0.5 if last == -1 else 1.0
            last = -1
    return high


@numba.njit(cache=True)
def ran(z, sides, t_end, h, s, stored):
    """Run on; shares of time, losses of contact, peaks, states at every step if stored."""
    count = len(sides)
    opened, stuck, peak = np.zeros(count), np.zeros(count), np.zeros(count)
    losses, events = np.zeros(count, np.int64), 0
    samples = np.zeros((stored, len(z)))
    steps = int(np.ceil(t_end / h - 1e-9))
    small = 1e-10 * s.scale
    for step in range(steps):
        left, at_once = min(h, t_end - step * h), 0
        if step < stored:
            samples[step] = z
        while left > 1e-9 * h:
            start = heights(z, sides, s)
            if (start < -small).any():
                which, length = int(np.argmax(start < -small)), 0.0
                after = z
            else:
                which, length, after = -1, left, stepped(z, left, sides, s)
                end = heights(after, sides, s)
                while (end < -small).any():
                    # the earliest by straight lines, located exactly
                    share = np.where(
                        end < -small,
                        np.maximum(start, 0.0) / (np.maximum(start, 0.0) - end),
                        2.0,
                    )
                    which = int(np.argmin(share))
                    length = located(
                        z, length, which, start[which], end[which], sides, s
                    )
                    after = stepped(z, length, sides, s) if length > 0.0 else z
                    end = heights(after, sides, s)
                    end[which] = 0.0
            opened += length * (sides == OPEN)
            stuck += length * (sides == 0)
            z, left = after.copy(), left - length
            at_once = 0 if length > 1e-9 * h else at_once + 1
            if at_once > 200:
                raise RuntimeError("regimes send the motion back and forth")
            if which >= 0:
                was = sides[which % count]
                changed(z, sides, which, s)
                events += 1
                losses[which % count] += sides[which % count] == OPEN and was != OPEN
        _, normal, _, _ = forces(z, sides, s)
        for i in range(count):
            if sides[i] != OPEN:
                peak[i] = max(peak[i], normal[i])
    return z, sides, opened, stuck, losses, events, peak, samples


class FallingMotion(Motion):
    """A structure whose contacts have laws of their own, and its state."""

    def __init__(self, structure, state=None):
        super().__init__(structure, state)
        laws = [law_of(friction) for friction in structure.frictions]
        self.laws = np.array([law for law, _ in laws], float)
        self.knots = np.array([knots for _, knots in laws])
        self.springs = np.full((len(laws), 3, KNOTS), np.inf)
        for springs, (at, force, slope) in zip(self.springs, self.tables, strict=True):
            springs[:, : len(at)] = at, force, slope
        self.mu = np.array(
            [
                coefficient(abs(speed), law, knots)
                for speed, law, knots in zip(
                    self.belt, self.laws, self.knots, strict=True
                )
            ]
        )
        self.mu, self.slope = self.mu.T
        stiffest = np.array([max(slopes) for *_, slopes in self.tables])
        at_rest = self.stiffness + (self.n * stiffest) @ self.n.T
        squares = la.eigh(0.5 * (at_rest + at_rest.T), self.mass, eigvals_only=True)
        self.step = 2.0 * np.pi / np.sqrt(squares.max()) / STEPS
        inverse = la.inv(self.mass)
        self.numbers = Numbers(
            inverse @ (self.load + np.zeros(len(inverse))),
            inverse @ self.stiffness,
            inverse @ self.damping,
            np.ascontiguousarray(self.n),
            np.ascontiguousarray(self.t),
            inverse @ self.n,
            inverse @ self.t,
            self.t.T @ inverse @ self.t,
            np.array(self.belt, float),
            np.array(self.pressed, float),
            self.springs,
            self.laws,
            self.knots,
            np.minimum(np.tile(np.abs(self.preload), 2), np.tile(np.abs(self.belt), 2)),
            STAGES,
            WEIGHTS,
        )

    def steady(self):
        """Displacement, normal forces and eigenvalues of steady sliding; None without any."""
        acting = self.n + np.sign(self.belt) * self.mu * self.t
        pieces = [
            0 if p < 0 else i for i, p in zip(self.piece, self.preload, strict=True)
        ]
        size, closed = len(self.mass), np.ones(len(pieces), bool)
        for _ in range(200):
            at, force, k = np.array(
                [
                    [column[i] for column in table]
                    for table, i in zip(self.tables, pieces, strict=True)
                ]
            ).T
            matrix = self.stiffness + (acting * k * closed) @ self.n.T
            pushed = force + k * (np.array(self.pressed) - at)
            q = la.solve(matrix, self.load + (acting * closed) @ pushed)
            deep = np.array(self.pressed) - self.n.T @ q
            now = [
                max(int(np.searchsorted(table[0], each, side="right")) - 1, 0)
                for table, each in zip(self.tables, deep, strict=True)
            ]
            if now == pieces and (closed == (deep > 0.0)).all():
                break
            pieces, closed = now, deep > 0.0
        else:
            return None
        force = (pushed - k * (self.n.T @ q)) * closed
        damping = self.damping + (self.t * force * self.slope) @ self.t.T
        first = np.block(
            [
                [np.zeros((size, size)), np.eye(size)],
                [-la.solve(self.mass, matrix), -la.solve(self.mass, damping)],
            ]
        )
        return q, force, *la.eig(first)

    def run(self, t_end, step=None):
        """Go on for a time; what was seen, with states at every ``step`` if that is given."""
        h = self.step if step is None else step
        stored = 0 if step is None else int(t_end / h)
        z, sides, opened, stuck, losses, events, peak, samples = ran(
            self.state.copy(), np.array(self.side), t_end, h, self.numbers, stored
        )
        self.state, self.side = z, sides.tolist()
        return {
            "open": opened,
            "stick": stuck,
            "losses": losses,
            "events": events,
            "peak": peak,
            "samples": samples if stored else None,
        }

    def dies_out(self, sliding, length):
        """Tell whether a push has become small."""
        size = len(self.mass)

        def far():
            away = self.state - np.append(sliding, np.zeros(size))
            return np.sqrt(
                away[:size] @ self.at_rest @ away[:size]
                + away[size:] @ self.mass @ away[size:]
            )

        begin = far()
        for _ in range(20):
            self.run(length)
            # at the rate of small motions a twentieth is left; a cycle that a push decays to may
            # have a third of its size
            if not 0.1 * begin < far() < 10.0 * begin:
                break
        return far() <= 0.1 * begin
