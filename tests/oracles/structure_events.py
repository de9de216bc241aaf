"""Event-driven integration of a structure on a belt by DOP853, from its matrices alone.

Contacts whose sliding speed is zero are settled by trying: the one combination of stick and slip
that agrees with Coulomb's law is taken. Nothing is shared with the package.
"""

from itertools import product

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

OPEN, STICK, SLOWER, FASTER = 0, 2, 1, -1
SAMPLES = 16
"""Points of a step at which signs are looked at."""


class Reference:
    """M q̈ + C q̇ + K q = f + Σ (n N + t T), with N = preload − k nᵀq and μ_s N in stick."""

    def __init__(self, structure, mu, mu_static=None, preload=1.0):
        self.mass, self.stiffness, self.damping = (
            matrix.toarray()
            for matrix in (structure.mass, structure.stiffness, structure.damping)
        )
        self.n, self.t = structure.normals, structure.tangentials
        self.k = np.array([each.stiffness for each in structure.contacts])
        self.preload = preload * np.array([each.preload for each in structure.contacts])
        self.belt = structure.belt_speed * np.array(
            [each.speed for each in structure.contacts]
        )
        self.load = structure.load * preload
        self.mu, self.mu_static = mu, mu if mu_static is None else mu_static
        self.inverse = np.linalg.inv(self.mass)
        self.size = len(self.mass)
        self.known = {}

    def pressing(self, z):
        return self.preload - self.k * (self.n.T @ z[: self.size])

    def sliding(self, z):
        return self.belt - self.t.T @ z[self.size :]

    def forces(self, z, modes):
        """q̈, and friction at each contact."""
        q, v = z[: self.size], z[self.size :]
        normal = np.where(modes == OPEN, 0.0, self.pressing(z))
        friction = np.where(np.abs(modes) == 1, modes * self.mu * normal, 0.0)
        force = self.load - self.stiffness @ q - self.damping @ v + self.n @ normal
        rate = self.inverse @ (force + self.t @ friction)
        held = np.flatnonzero(modes == STICK)
        if held.size:
            columns = self.t[:, held]
            needed = np.linalg.solve(
                columns.T @ self.inverse @ columns, -columns.T @ rate
            )
            friction[held] = needed
            rate = rate + self.inverse @ (columns @ needed)
        return rate, friction

    def rates(self, z, modes):
        return np.concatenate([z[self.size :], self.forces(z, modes)[0]])

    def laws(self, modes):
        """Matrix and offset of z′, and of what must stay positive: of each contact three numbers.

        They are made once of each combination of modes.
        """
        slips, sticks = np.abs(modes) == 1, modes == STICK

        def positive(z):
            normal, friction = self.pressing(z), self.forces(z, modes)[1]
            limit = self.mu_static * normal
            slides = np.where(slips, modes * self.sliding(z), 1.0)
            return np.concatenate(
                [
                    np.where(modes == OPEN, -normal, normal),
                    np.where(sticks, limit - friction, slides),
                    np.where(sticks, limit + friction, 1.0),
                ]
            )

        if (key := tuple(modes)) not in self.known:
            found = []
            for law in (lambda z: self.rates(z, modes), positive):
                offset = law(np.zeros(2 * self.size))
                columns = [law(unit) - offset for unit in np.eye(2 * self.size)]
                found += [np.array(columns).T.copy(), offset]
            self.known[key] = found
        return self.known[key]

    def settled(self, z, modes, loose):
        """The modes of contacts at rest on the belt, and the velocities that stick gives them."""
        found = []
        for tried in product((STICK, SLOWER, FASTER), repeat=len(loose)):
            modes = modes.copy()
            modes[loose] = tried
            rate, friction = self.forces(z, modes)
            limit = self.mu_static * self.pressing(z)
            slide = -self.t.T @ rate
            fits = all(
                abs(friction[i]) <= limit[i]
                if modes[i] == STICK
                else modes[i] * slide[i] > 0.0
                for i in loose
            )
            if fits:
                found.append(modes)
        assert found, "no combination of stick and slip agrees with the law"
        # with a static limit above that of slip several do: what can stick does
        modes = max(found, key=lambda each: int((each == STICK).sum()))
        held = np.flatnonzero(modes == STICK)
        if held.size:
            columns = self.t[:, held]
            impulse = np.linalg.solve(
                columns.T @ self.inverse @ columns, self.sliding(z)[held]
            )
            z = z.copy()
            z[self.size :] += self.inverse @ (columns @ impulse)
        return z, modes

    def run(self, t_end, z, rtol=1e-12, atol=1e-14):
        """Times, contacts and new modes of all events, and the states at ``t_end``."""
        normal, speed = self.pressing(z), self.sliding(z)
        modes = np.where(normal < 0, OPEN, np.sign(speed).astype(int))
        time, events = 0.0, []
        while time < t_end:
            time, z, hit = self.leg(time, z, modes, t_end, rtol, atol)
            for which in hit:
                before = modes.copy()
                contact, of_speed = which % len(self.k), which >= len(self.k)
                if not of_speed and modes[contact] == OPEN:
                    modes[contact] = int(np.sign(self.sliding(z)[contact]))
                elif not of_speed:
                    modes[contact] = OPEN
                else:
                    if modes[contact] == STICK:  # leaves it to the side of its friction
                        friction = self.forces(z, modes)[1][contact]
                        modes[contact] = int(np.sign(friction))
                        loose = set(np.flatnonzero(modes == STICK))
                    else:
                        loose = {contact, *np.flatnonzero(modes == STICK)}
                    z, modes = self.settled(z, modes, sorted(loose))
                others = set(np.flatnonzero(before != modes)) - {contact}
                events += [
                    (time, int(i), int(modes[i])) for i in (contact, *sorted(others))
                ]
        return events, z

    def leg(self, time, z, modes, t_end, rtol, atol):
        """To the next event: time, state, and which numbers vanish there."""
        matrix, offset, signs, levels = self.laws(modes)
        solver = DOP853(
            lambda _, y: matrix @ y + offset, time, z, t_end, rtol=rtol, atol=atol
        )
        scale = np.concatenate(
            [self.preload, np.minimum(self.preload, np.abs(self.belt)), self.preload]
        )
        left = np.abs(signs @ z + levels) < 1e-9 * scale  # zero where the leg starts
        while solver.status == "running":
            solver.step()
            dense, start = solver.dense_output(), solver.t_old
            times = np.linspace(start, solver.t, SAMPLES + 1)
            below = signs @ dense(times[1:]) + levels[:, None] < 0.0
            if below.any():
                place = int(below.any(axis=0).argmax())
                crossed = np.flatnonzero(below[:, place])
                span = times[place], times[place + 1]
                roots = [
                    root(dense, signs[i], levels[i], span, begins=left[i] and not place)
                    for i in crossed
                ]
                first = min(roots)
                close = [
                    i
                    for i, each in zip(crossed, roots, strict=True)
                    if each - first < 1e-12 * times[place + 1]
                ]
                return first, dense(first), close
            left[:] = False
        return t_end, solver.y, []


def root(dense, row, level, span, *, begins):
    """Where row · z + level falls through zero; from zero it may rise first, for a moment."""

    def height(t):
        return row @ dense(t) + level

    start, end = span
    if begins:
        tries = start + (end - start) / 2.0 ** np.arange(1, 40)
        start = next((t for t in tries if height(t) > 0.0), start)
    if height(start) <= 0.0:
        return start
    return brentq(height, start, end, xtol=1e-16 * end)
