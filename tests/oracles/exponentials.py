"""An integrator apart for structures with Coulomb friction: matrix exponentials between events.

While no contact changes, ẋ = A x + b with x = (q, v): steps of equal length are one product each.
Where a surface changes its sign in a step, the instant is located by exponentials of half, quarter,
… of it. It shares nothing with the package but the matrices.
"""

import numpy as np
import scipy.linalg as la

from squealpipe.structures.modes import modal_damping_of

OPEN, SLOWER, FASTER, STICK = range(4)


class Exponentials:
    """A structure with M, C, K and contacts as arrays."""

    def __init__(self, structure):
        s = structure
        self.n, self.m = s.size, len(s.contacts)
        self.mass, self.stiffness = s.mass.toarray(), s.stiffness.toarray()
        modal = modal_damping_of(s)
        self.damping = s.damping.toarray()
        if modal is not None:
            self.damping = self.damping + modal.product(np.eye(self.n))
        self.normals, self.tangentials = s.normals, s.tangentials
        self.k, self.preload = s.stiffnesses, s.preloads
        self.speed, self.mu, self.load = s.speeds * s.belt_speed, s.mu, s.load
        self.known = {}

    def affine(self, regimes):
        """A (2 n, 2 n), b, and stick forces as T = R x + r."""
        n, inverse = self.n, np.linalg.inv(self.mass)
        closed = regimes != OPEN
        drag = np.select([regimes == SLOWER, regimes == FASTER], [self.mu, -self.mu], 0)
        acting = (self.normals + self.tangentials * drag) * closed
        pull = np.hstack([-self.stiffness, -self.damping])
        pull[:, :n] -= acting @ (self.normals * self.k).T
        constant = self.load + acting @ self.preload
        held = np.flatnonzero(regimes == STICK)
        forces, offset = np.zeros((self.m, 2 * n)), np.zeros(self.m)
        if held.size:
            t = self.tangentials[:, held]
            solve = -np.linalg.solve(t.T @ inverse @ t, t.T @ inverse)
            forces[held], offset[held] = solve @ pull, solve @ constant
            pull, constant = pull + t @ forces[held], constant + t @ offset[held]
        a = np.zeros((2 * n, 2 * n))
        a[:n, n:], a[n:] = np.eye(n), inverse @ pull
        return a, np.concatenate([np.zeros(n), inverse @ constant]), forces, offset

    def step(self, regimes, h):
        """exp of (A, b) over a time, as (Φ, φ)."""
        a, b, *_ = self.affine(regimes)
        whole = la.expm(
            np.block([[a, b[:, None]], [np.zeros((1, a.shape[1] + 1))]]) * h
        )
        return whole[:-1, :-1], whole[:-1, -1]

    def surfaces(self, regimes, forces, offset):
        """What is ≥ 0 while nothing switches: rows and constants, two for each contact."""
        n, rows, constants = self.n, [], []
        for i, regime in enumerate(regimes):
            normal = np.concatenate([-self.k[i] * self.normals[:, i], np.zeros(n)])
            slide = np.concatenate([np.zeros(n), -self.tangentials[:, i]])
            sign = -1.0 if regime == OPEN else 1.0
            rows.append(sign * normal)
            constants.append(sign * self.preload[i])
            if regime in (SLOWER, FASTER):
                sign = 1.0 if regime == SLOWER else -1.0
                rows.append(sign * slide)
                constants.append(sign * self.speed[i])
            elif regime == STICK:
                for sign in (1.0, -1.0):
                    rows.append(self.mu * normal + sign * forces[i])
                    constants.append(self.mu * self.preload[i] + sign * offset[i])
        return np.array(rows), np.array(constants)

    def of(self, regimes, h):
        """All that belongs to one set of regimes."""
        key = regimes.tobytes()
        if key not in self.known:
            _, _, forces, offset = self.affine(regimes)
            owners = np.repeat(
                np.arange(self.m),
                [3 if r == STICK else 1 if r == OPEN else 2 for r in regimes],
            )
            surfaces = self.surfaces(regimes, forces, offset)
            self.known[key] = (*self.step(regimes, h), *surfaces, owners)
        return self.known[key]

    def halves(self, regimes, h):
        """Exponentials over h/2, h/4, …"""
        key = (regimes.tobytes(), "halves")
        if key not in self.known:
            steps = [h / 2**k for k in range(1, 45)]
            self.known[key] = [(*self.step(regimes, each), each) for each in steps]
        return self.known[key]

    def start(self, x):
        """The regimes of a state in which nothing sticks."""
        force = self.preload - self.k * (self.normals.T @ x[: self.n])
        slide = self.speed - self.tangentials.T @ x[self.n :]
        return np.where(force <= 0, OPEN, np.where(slide > 0, SLOWER, FASTER))

    def run(self, x, t_end, t_late, h):
        """Shares of the time from t_late on, by contact: open and sticking; peak forces, events."""
        x, regimes = x.copy(), self.start(x)
        shares, peaks, events = np.zeros((2, self.m)), np.zeros(self.m), 0
        t, kinetic = 0.0, []
        while t < t_end:
            phi, constant, rows, offsets, owners = self.of(regimes, h)
            new = phi @ x + constant
            height = rows @ new + offsets
            crossed = (height < 0) & (rows @ x + offsets > height)
            took = h
            if crossed.any():
                # binary digits of the instant: the largest step that no surface is crossed in
                took, new = 0.0, x
                for part, rest, share in self.halves(regimes, h):
                    tried = part @ new + rest
                    if not ((rows @ tried + offsets < 0) & crossed).any():
                        took, new = took + share, tried
                value = np.where(crossed, rows @ (part @ new + rest) + offsets, np.inf)
                place = int(value.argmin())
            if t >= t_late:
                shares[0] += took * (regimes == OPEN)
                shares[1] += took * (regimes == STICK)
                force = self.preload - self.k * (self.normals.T @ new[: self.n])
                peaks = np.maximum(peaks, force)
                kinetic.append(new[self.n :])
            x, t = new, t + took
            if crossed.any():
                regimes, x = self.switch(regimes, x, place, owners)
                events += t >= t_late
        span = t - t_late
        return shares / span, peaks, events / span, np.array(kinetic)

    def switch(self, regimes, x, place, owners):
        """The regimes after a surface has been crossed, and the state."""
        i, regimes = int(owners[place]), regimes.copy()
        first = place == int(np.flatnonzero(owners == i)[0])
        before = regimes[i]
        if before == OPEN:
            slide = self.speed[i] - self.tangentials[:, i] @ x[self.n :]
            regimes[i] = SLOWER if slide > 0 else FASTER
        elif first:
            regimes[i] = OPEN
        elif before == STICK:
            second = place == int(np.flatnonzero(owners == i)[1])
            regimes[i] = FASTER if second else SLOWER
        else:
            t = np.linalg.solve(self.mass, self.tangentials[:, i])
            off = self.speed[i] - self.tangentials[:, i] @ x[self.n :]
            x = x.copy()
            x[self.n :] += t * off / (self.tangentials[:, i] @ t)
            regimes[i] = STICK
            _, _, forces, offset = self.affine(regimes)
            needed = forces[i] @ x + offset[i]
            limit = self.mu * (
                self.preload[i] - self.k[i] * self.normals[:, i] @ x[: self.n]
            )
            if abs(needed) > limit:
                regimes[i] = FASTER if before == SLOWER else SLOWER
        return regimes, x
