"""Answers for structures on a belt by own eigenvalues and runs of exponentials; shares no code.

Small motions are those about the one state of steady sliding in which the forces of closed contacts
are positive. A run is a sum of exponentials between events (Coulomb friction alone), whose roots
are bracketed on a fine grid of times.
"""

import numpy as np
import scipy.linalg as la
from scipy.optimize import brentq

from tests.oracles.many_contacts import OPEN, ManyContacts
from tests.oracles.pad import strongest_line

QUIET, SQUEALS, HAMMERS = "quiet", "squeals", "hammers"
POINTS = 24
"""Points in a period of the fastest mode at which signs are looked at."""


class Motion(ManyContacts):
    """A structure with its damping of modes, and its state."""

    def __init__(self, structure, state=None):
        size = structure.size
        if state is None:
            state = np.zeros(2 * size)
        super().__init__(structure, state[:size], state[size:])
        self.k = structure.stiffnesses  # no tables
        at_rest = self.stiffness + (self.n * self.k) @ self.n.T
        squares, modes = la.eigh(0.5 * (at_rest + at_rest.T), self.mass)
        self.omega, self.modes = np.sqrt(np.maximum(squares, 0.0)), modes
        ratios = np.broadcast_to(structure.modal_damping, size)
        of_modes = self.mass @ modes
        self.damping = (
            self.damping + (of_modes * (2.0 * ratios * self.omega)) @ of_modes.T
        )
        self.at_rest = at_rest
        self.known = {}

    def steady(self):
        """Displacement, normal forces and eigenvalues of steady sliding; None without any."""
        count, sign = len(self.k), np.sign(self.belt)
        if not self.belt.all():
            return None
        acting = self.n + sign * self.mu * self.t
        for combination in range(2**count - 1, -1, -1):
            closed = np.array([bool(combination >> i & 1) for i in range(count)])
            matrix = self.stiffness + (acting * self.k * closed) @ self.n.T
            q = la.solve(matrix, self.load + (acting * closed) @ self.preload)
            force = self.preload - self.k * (self.n.T @ q)
            if (closed == (force > 0.0)).all():
                size = len(self.mass)
                first = np.block(
                    [
                        [np.zeros((size, size)), np.eye(size)],
                        [
                            -la.solve(self.mass, matrix),
                            -la.solve(self.mass, self.damping),
                        ],
                    ]
                )
                return q, force * closed, *la.eig(first)
        return None

    @property
    def growth(self):
        """Largest growth rate, 1/s; infinite without steady sliding."""
        steady = self.steady()
        return np.inf if steady is None else steady[2].real.max()

    def push(self, share=0.01):
        """Start from steady sliding, pushed along the mode that grows fastest."""
        q, _, values, vectors = self.steady()
        size = len(q)
        fastest = values.real >= values.real.max() - 1e-9 * np.abs(values).max()
        place = np.flatnonzero(fastest)[np.argmin(np.abs(values[fastest]))]
        shape = vectors[:, place]
        shape = shape * np.exp(-0.5j * np.angle((shape[:size] ** 2).sum()))
        away = shape.real
        energy = 0.5 * (
            away[size:] @ self.mass @ away[size:]
            + away[:size] @ self.at_rest @ away[:size]
        )
        stored = (self.preload**2 / (2.0 * self.k)).sum()
        away = away * share * np.sqrt(stored / energy)
        self.state = np.concatenate([q, np.zeros(size)]) + away
        self.side = [
            OPEN if force <= 0 else int(np.sign(speed))
            for force, speed in zip(
                self.normal(self.state), self.speed(self.state), strict=True
            )
        ]

    def flow(self, sides):
        key = tuple(sides)
        if key not in self.known:
            whole, held = super().flow(sides)
            # what is held moves at constant speed: a double eigenvalue 0, with one eigenvector
            if 0 in sides:
                part = np.random.default_rng(0).standard_normal(whole.shape)
                part[-1] = 0.0
                values, vectors = la.eig(whole + 1e-10 * part)
            else:
                values, vectors = la.eig(whole)
            self.known[key] = whole, held, values, vectors, la.inv(vectors)
        return self.known[key][:2]

    def settle(self):
        """Do what happens at one instant; heights that sums of exponentials leave count as 0."""
        same = np.array([1e-7, 1e-5, 1e-3])  # of a height and its two derivatives
        for _ in range(100):
            whole, held = self.flow(self.side)
            now = np.append(self.state, 1.0)
            for i, what, row in self.guards(held):
                heights = row @ now, row @ whole @ now, row @ whole @ whole @ now
                clear = [h for h, s in zip(heights, same, strict=True) if abs(h) > s]
                if clear and clear[0] < 0.0:
                    self.change(i, what)
                    break
            else:
                return
        raise RuntimeError("regimes send the motion back and forth")

    def run(self, t_end, step=None):
        """Go on for a time; what was seen, with states at every ``step`` if that is given."""
        count = len(self.k)
        scan = 2.0 * np.pi / self.omega.max() / POINTS
        seen = {
            "open": np.zeros(count),
            "stick": np.zeros(count),
            "losses": np.zeros(count, int),
            "events": 0,
            "peak": np.zeros(count),
        }
        samples, taken, time = [], 0, 0.0
        while time < t_end * (1.0 - 1e-12):
            _, held = self.flow(self.side)
            _, _, values, vectors, inverse = self.known[tuple(self.side)]
            rows = np.array([row for *_, row in self.guards(held)])
            part = inverse @ np.append(self.state, 1.0)
            times = scan * np.arange(65)
            times = times[times < t_end - time]
            times = np.append(times, min(scan * 65, t_end - time))
            states = (vectors @ (part[:, None] * np.exp(values[:, None] * times))).real
            heights = rows @ states
            scale = np.abs(rows) @ np.abs(states).max(axis=1) + 1e-300
            # what starts at zero has to leave it first
            low = heights[:, 1:] < -1e-11 * scale[:, None]
            end, hit = times[-1], False
            if low.any():
                place = int(low.any(axis=0).argmax())
                roots = [
                    _root(
                        (rows[i] @ vectors) * part,
                        values,
                        times[place],
                        times[place + 1],
                    )
                    for i in np.flatnonzero(low[:, place])
                ]
                end, hit = min(roots), True
            seen_states = states[:, times <= end]
            if step is not None:
                at = []
                while taken * step < time + end:
                    at.append(max(taken * step - time, 0.0))
                    taken += 1
                if at:
                    exponentials = np.exp(values[:, None] * np.array(at))
                    between = (vectors @ (part[:, None] * exponentials)).real
                    samples.append(between[:-1].T)
                    seen_states = np.hstack([seen_states, between])
            sides = np.array(self.side)
            seen["open"] += end * (sides == OPEN)
            seen["stick"] += end * (sides == 0)
            forces = self.preload[:, None] - self.k[:, None] * (
                self.n.T @ seen_states[: len(self.mass)]
            )
            forces[sides == OPEN] = 0.0
            seen["peak"] = np.maximum(seen["peak"], forces.max(axis=1))
            self.state = (vectors @ (part * np.exp(values * end))).real[:-1]
            time += end
            if hit:
                self.settle()
                after = np.array(self.side)
                seen["losses"] += (after == OPEN) & (sides != OPEN)
                seen["events"] += 1
        seen["samples"] = np.concatenate(samples) if samples else None
        return seen

    def dies_out(self, _, length):
        """Tell whether small motions, which are linear until a contact switches, stay so."""
        return not self.run(length)["events"]

    def answer(self, most=3000.0):
        """Verdict on a push, with frequency, levels and the differences of two halves."""
        steady = self.steady()
        if steady is None:
            return {"verdict": "no sliding"}
        values = steady[2]
        growth = values.real.max()
        grows = values[(values.real > 0.0) & (values.imag > 0.0)]
        slow = (
            np.abs(grows.imag).min()
            if grows.size
            else values.imag[values.imag > 0].min()
        )
        period = 2.0 * np.pi / slow
        self.push()
        begin = self.state - np.concatenate([steady[0], 0.0 * steady[0]])
        if growth <= 0.0:
            # linear until a contact switches, and smaller after each e-folding
            length = min(max(3.0 / -growth, 30.0 * period), most * period)
            if self.dies_out(steady[0], length):
                return {"verdict": QUIET, "growth": growth}
        else:
            self.run(min(np.log(300.0) / growth, most * period) + 600.0 * period)
        step = 2.0 * np.pi / self.omega.max() / 16
        halves = []
        for _ in range(8):
            halves = [
                self._measured(self.run(200.0 * period, step), step, period)
                for _ in "12"
            ]
            one, other = halves
            total = max(one["along"], one["across"], 1e-300)
            close = max(abs(one[k] - other[k]) / total for k in ("along", "across"))
            if close < 0.02 and abs(one["open"] - other["open"]) < 0.02:
                break
        found = {
            key: 0.5 * (halves[0][key] + halves[1][key])
            for key in ("along", "across", "open", "stick")
        }
        found |= {
            f"{key}_error": abs(halves[0][key] - halves[1][key])
            for key in ("along", "across", "open", "stick")
        }
        losses = min(each["losses"] for each in halves)
        small = halves[1]["largest"] < 10.0 * np.linalg.norm(begin) and not losses
        found["verdict"] = (
            HAMMERS
            if losses >= 2
            else QUIET
            if growth <= 0.0 and small and halves[1]["along"] < halves[0]["along"]
            else SQUEALS
        )
        found["frequencies"] = [each["frequency"] for each in halves]
        found["growth"], found["period"] = growth, period
        return found

    def _measured(self, seen, step, period):
        size = len(self.mass)
        z = seen["samples"]
        along, across = z[:, size:] @ self.t, z[:, size:] @ self.n
        variance = along.var(axis=0) + across.var(axis=0)
        contact = int(variance.argmax())
        loud = max((along[:, contact], across[:, contact]), key=lambda each: each.var())
        return {
            "along": np.sqrt((along**2).mean()),
            "across": np.sqrt((across**2).mean()),
            "open": (seen["open"] / (200.0 * period)).max(),
            "stick": (seen["stick"] / (200.0 * period)).max(),
            "losses": seen["losses"].max(),
            "frequency": strongest_line(loud, step) if loud.std() > 0 else np.nan,
            "largest": np.linalg.norm(z - z.mean(axis=0), axis=1).max(),
        }


def _root(row, values, low, high):
    def height(t):
        return float((row * np.exp(values * t)).sum().real)

    if height(low) <= 0.0:  # it was at zero, left it and came back within one step
        tries = low + (high - low) * 0.5 ** np.arange(1, 30)
        low = next((t for t in tries if height(t) > 0.0), None)
        if low is None:
            raise RuntimeError("an event at once")
    if height(high) >= 0.0:  # seen below by round-off alone
        return high
    return brentq(height, low, high, xtol=1e-15 * high, rtol=1e-14)
