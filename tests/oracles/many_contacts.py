"""Structures with friction contacts, event by event with matrix exponentials; shares no code.

Coulomb friction with one coefficient makes a motion linear between events. Which contacts stick
after an event is found by trying all combinations of those that are at belt speed; for
independent directions one alone violates nothing.
"""

from itertools import product

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

OPEN = 2
"""Side of a contact that is open; 1 and −1 are slip slower and faster than the belt, 0 stick."""
SAME = 1e-9
"""Heights and speeds below this are one event."""
NOTHING = 1e-13
"""Round-off of heights and slopes."""


class ManyContacts:
    """A structure's matrices, and the state with the side of each contact."""

    def __init__(self, structure, q, v):
        self.mass = np.asarray(structure.mass.todense())
        self.stiffness = np.asarray(structure.stiffness.todense())
        self.damping = np.asarray(structure.damping.todense())
        self.n, self.t = structure.normals, structure.tangentials
        self.k, self.preload = structure.stiffnesses, structure.preloads
        self.belt = structure.speeds * structure.belt_speed
        self.mu, self.load = structure.mu, structure.load
        self.state = np.array([*q, *v])
        self.side = [
            OPEN if force <= 0 else int(np.sign(speed))
            for force, speed in zip(
                self.normal(self.state), self.speed(self.state), strict=True
            )
        ]

    def normal(self, z):
        return self.preload - self.k * (self.n.T @ z[: len(self.mass)])

    def speed(self, z):
        return self.belt - self.t.T @ z[len(self.mass) :]

    def flow(self, sides):
        """z′ = A z + b as one matrix, and rows (of z and 1) that give the forces of stick."""
        size = len(self.mass)
        force = np.zeros((size, 2 * size + 1))
        force[:, :size], force[:, size : 2 * size] = -self.stiffness, -self.damping
        force[:, -1] = self.load
        for i, side in enumerate(sides):
            if side == OPEN:
                continue
            row = np.zeros(2 * size + 1)
            row[:size], row[-1] = -self.k[i] * self.n[:, i], self.preload[i]
            force += np.outer(self.n[:, i] + side * self.mu * self.t[:, i], row)
        stuck = [i for i, side in enumerate(sides) if side == 0]
        held = np.zeros((len(sides), 2 * size + 1))
        if stuck:
            along = self.t[:, stuck]
            mobility = along.T @ np.linalg.solve(self.mass, along)
            held[stuck] = -np.linalg.solve(
                mobility, along.T @ np.linalg.solve(self.mass, force)
            )
            force = force + along @ held[stuck]
        whole = np.zeros((2 * size + 1, 2 * size + 1))
        whole[:size, size : 2 * size] = np.eye(size)
        whole[size : 2 * size] = np.linalg.solve(self.mass, force)
        return whole, held

    def guards(self, held):
        """(contact, what, row of z and 1): events where the row's product falls through 0."""
        size = len(self.mass)
        for i, side in enumerate(self.side):
            normal, speed = np.zeros((2, 2 * size + 1))
            normal[:size], normal[-1] = -self.k[i] * self.n[:, i], self.preload[i]
            speed[size : 2 * size], speed[-1] = -self.t[:, i], self.belt[i]
            if side == OPEN:
                yield i, "lands", -normal
                continue
            yield i, "lifts", normal
            if side:
                yield i, "belt", side * speed
            else:
                yield i, "slips slower", self.mu * normal - held[i]
                yield i, "slips faster", self.mu * normal + held[i]

    def settle(self, at_belt):
        """The sides of contacts at belt speed that violate nothing."""
        size, z = len(self.mass), np.append(self.state, 1.0)
        best = (-np.inf, None)
        for chosen in product((0, 1, -1), repeat=len(at_belt)):
            sides = list(self.side)
            for i, side in zip(at_belt, chosen, strict=True):
                sides[i] = side
            whole, held = self.flow(sides)
            pulls = self.t.T @ (whole @ z)[size : 2 * size]
            limits, holds = self.mu * self.normal(self.state), held @ z
            margins = [
                -sides[i] * pulls[i] if sides[i] else limits[i] - abs(holds[i])
                for i in at_belt
            ]
            best = max(
                best, (min(margins, default=0.0), sides), key=lambda each: each[0]
            )
        self.side = best[1]

    def next_event(self, step):
        """Go to the next event: its time from here."""
        whole, held = self.flow(self.side)
        guards = list(self.guards(held))
        rows = np.array([row for *_, row in guards])
        now, elapsed = np.append(self.state, 1.0), 0.0
        first, later = expm(whole * step / 64), expm(whole * step)
        while True:
            h = step if elapsed else step / 64
            end = (later if elapsed else first) @ now
            hit = _crossing(whole, rows, now, end, h, begins=not elapsed)
            if hit is not None:
                now = expm(whole * hit) @ now
                self.state = now[:-1]
                heights, slopes = rows @ now, rows @ whole @ now
                falls = (abs(heights) < SAME) & (slopes < 0)
                self.change([guards[k][:2] for k in np.flatnonzero(falls)])
                return elapsed + hit
            now, elapsed = end, elapsed + h

    def change(self, events):
        """Carry out what happens at one instant."""
        size, asks = len(self.mass), False
        speeds = self.speed(self.state)
        for i, what in events:
            if what == "lifts":
                self.side[i] = OPEN
            elif what == "lands":
                self.side[i] = int(np.sign(speeds[i]))
            elif what.startswith("slips"):  # friction goes on from its limit
                self.side[i] = 1 if what == "slips slower" else -1
            asks |= what == "belt"
        if not asks:
            return
        met = {i for i, what in events if what == "belt" and self.side[i] != OPEN}
        at_belt = [i for i, side in enumerate(self.side) if side == 0 or i in met]
        along = self.t[:, at_belt]
        moved = np.linalg.solve(self.mass, along)
        self.state[size:] += moved @ np.linalg.solve(along.T @ moved, speeds[at_belt])
        self.settle(at_belt)


def _crossing(whole, rows, start, end, h, *, begins):
    """The earliest root in a step of what is above zero at first, touching pairs too."""
    earliest = None
    slopes = rows @ whole @ start, rows @ whole @ end
    for row, before, after in zip(rows, *slopes, strict=True):

        def height(t, row=row):
            return row @ expm(whole * t) @ start

        def slope(t, row=row):
            return row @ whole @ expm(whole * t) @ start

        left = 0.0
        low = h if row @ end < -NOTHING else None
        if low is None and not (before < -NOTHING and after > NOTHING):
            continue
        if (
            begins and abs(row @ start) < SAME
        ):  # it leaves zero, and may be back at once
            tries = [h / 2**k for k in range(1, 24) if height(h / 2**k) > 0.0]
            if not tries:
                raise RuntimeError("an event at once")
            left = tries[0]
        if low is None:
            if not slope(left) < 0.0:
                continue
            bottom = brentq(slope, left, h, xtol=1e-15)
            low = bottom if height(bottom) < -NOTHING else None
        if low is not None:
            root = brentq(height, left, low, xtol=1e-15)
            earliest = root if earliest is None else min(root, earliest)
    return earliest
