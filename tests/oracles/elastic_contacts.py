"""Contacts with tangential springs and rigid ones, by matrix exponentials; shares no code.

Each combination of regimes is a linear system of displacements, velocities, stretches and 1. A step
is looked through for the first surface that falls through zero: by the signs at its ends, or at a
turning point inside. Steps must be short beside all periods.
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

SIDES = {"slip_slower": 1.0, "slip_faster": -1.0}


class ElasticContacts:
    """A structure's matrices, and what its contacts do at switches."""

    def __init__(self, structure):
        self.inverse = np.linalg.inv(structure.mass.toarray())
        self.stiffness = structure.stiffness.toarray()
        self.damping = structure.damping.toarray()
        self.load, self.size = structure.load, structure.size
        self.contacts, self.belt = structure.contacts, structure.belt_speed
        self.mu = [each.mu for each in structure.frictions]
        self.static = [each.static_mu for each in structure.frictions]
        self.n, self.t = structure.normals.T, structure.tangentials.T
        sprung = [each.tangential_stiffness is not None for each in self.contacts]
        places = np.flatnonzero(sprung)
        self.place = {i: 2 * self.size + a for a, i in enumerate(places)}
        self.width = 2 * self.size + len(self.place) + 1
        self.known = {}

    def row(self, displacement=0.0, velocity=0.0, constant=0.0):
        row, n = np.zeros(self.width), self.size
        row[:n], row[n : 2 * n], row[-1] = displacement, velocity, constant
        return row

    def normal(self, i):
        contact = self.contacts[i]
        return self.row(-contact.stiffness * self.n[i], 0.0, contact.preload)

    def normal_rate(self, i):
        return self.row(0.0, -self.contacts[i].stiffness * self.n[i])

    def speed(self, i):
        return self.row(0.0, -self.t[i], self.contacts[i].speed * self.belt)

    def system(self, regimes):
        """The matrix of the rates, and friction by contact, in these regimes."""
        key = tuple(regimes)
        if key in self.known:
            return self.known[key]
        n, matrix, friction = self.size, np.zeros((self.width, self.width)), {}
        force = np.zeros((n, self.width))
        force[:, :n], force[:, n : 2 * n] = -self.stiffness, -self.damping
        force[:, -1] = self.load
        for i, regime in enumerate(regimes):
            if regime == "separated":
                continue
            force += np.outer(self.n[i], self.normal(i))
            if regime in SIDES:
                friction[i] = SIDES[regime] * self.mu[i] * self.normal(i)
            elif i in self.place:
                friction[i] = np.zeros(self.width)
                friction[i][self.place[i]] = self.contacts[i].tangential_stiffness
                matrix[self.place[i]] = self.speed(i)
            if i in friction:
                force += np.outer(self.t[i], friction[i])
        rigid = [
            i for i, r in enumerate(regimes) if r == "stick" and i not in self.place
        ]
        if rigid:
            t = self.t[rigid]
            held = -np.linalg.solve(t @ self.inverse @ t.T, t @ self.inverse @ force)
            friction |= dict(zip(rigid, held, strict=True))
            force = force + t.T @ held
        matrix[:n, n : 2 * n], matrix[n : 2 * n] = np.eye(n), self.inverse @ force
        self.known[key] = matrix, friction, {}
        return self.known[key]

    def surfaces(self, regimes):
        """(row, contact, kind) of what ends these regimes where it falls through zero."""
        _, friction, _ = self.system(regimes)
        for i, regime in enumerate(regimes):
            normal = self.normal(i)
            if regime == "separated":
                yield -normal, i, "contact"
                continue
            yield normal, i, "separation"
            if regime in SIDES:
                row = SIDES[regime] * self.speed(i)
                if i in self.place:
                    spring = self.contacts[i].tangential_stiffness
                    row = row - self.mu[i] / spring * self.normal_rate(i)
                yield row, i, "belt speed"
            else:
                yield self.static[i] * normal - friction[i], i, "slip_slower"
                yield self.static[i] * normal + friction[i], i, "slip_faster"

    def after(self, regimes, x, i, kind):
        """Regimes and state after a switch, and the event."""
        regimes, x, sprung = list(regimes), x.copy(), i in self.place
        before, spring = regimes[i], self.contacts[i].tangential_stiffness
        if kind == "separation":
            regimes[i] = "separated"
        elif kind == "contact":
            speed = self.speed(i) @ x
            regimes[i] = "slip_slower" if speed >= 0 else "slip_faster"
            limit = self.static[i] * (self.normal_rate(i) @ x)
            if sprung and spring * abs(speed) <= limit:
                regimes[i] = "stick"
        elif kind in SIDES:
            regimes[i], kind = kind, "slip"
        elif sprung:
            stretch = SIDES[before] * self.mu[i] * (self.normal(i) @ x) / spring
            x[self.place[i]], regimes[i], kind = stretch, "stick", "stick"
        else:
            push, n = self.inverse @ self.t[i], self.size
            x[n : 2 * n] += push * (self.speed(i) @ x) / (self.t[i] @ push)
            regimes[i], kind = "stick", "stick"
            friction = self.system(regimes)[1][i] @ x
            if abs(friction) > self.static[i] * (self.normal(i) @ x):
                other = {"slip_slower": "slip_faster", "slip_faster": "slip_slower"}
                regimes[i], kind = other[before], "reversal"
        if sprung and kind in {"separation", "contact"}:
            x[self.place[i]] = 0.0
        return regimes, x, f"{self.contacts[i].name}_{kind}"

    def state(self, regimes, x):
        """The state with the stretches that follow from it."""
        x = x.copy()
        for i, place in self.place.items():
            spring = self.contacts[i].tangential_stiffness
            if regimes[i] != "stick":
                side = SIDES.get(regimes[i], 0.0)
                x[place] = side * self.mu[i] * (self.normal(i) @ x) / spring
        return x[:-1]

    def run(self, regimes, start, times, step):
        """Events (time, name), and the states at the times, the last of which is the end."""
        x, t, events, found = np.append(start, 1.0), 0.0, [], []
        fresh = set()
        while True:
            matrix, _, exponentials = self.system(regimes)
            length = min(step, times[-1] - t)
            if length not in exponentials:
                exponentials[length] = expm(matrix * length)
            end = exponentials[length] @ x

            def at(time, matrix=matrix, x=x):
                return expm(matrix * time) @ x

            first, switch = length, None
            for row, i, kind in self.surfaces(regimes):
                root = self._falls(row, matrix, x, end, length, at, (i, kind) in fresh)
                if root is not None and root < first:
                    first, switch = root, (i, kind)
            while len(found) < len(times) and times[len(found)] <= t + first:
                found.append(self.state(regimes, at(times[len(found)] - t)))
            if switch is None and len(found) == len(times):
                return events, np.array(found)
            t, x, fresh = t + first, end, set()
            if switch is not None:
                regimes, x, name = self.after(regimes, at(first), *switch)
                events.append((t, name))
                # what is zero but for round-off has just been crossed, or begins from there
                fresh = {
                    (i, kind)
                    for row, i, kind in self.surfaces(regimes)
                    if abs(row @ x) <= 1e-11 * np.abs(row * x).sum()
                }

    @staticmethod
    def _falls(row, matrix, x, end, length, at, fresh):
        """When a surface first falls through zero in a step, or None."""

        def height(time):
            return row @ at(time)

        turns = row @ matrix

        def slope(time):
            return turns @ at(time)

        size, low = np.abs(row * x).sum(), 1e-4 * length if fresh else 0.0
        if not fresh and row @ x <= 0:
            return 0.0
        if row @ end < 0:
            if height(low) <= 0:
                return 0.0
            return brentq(height, low, length, xtol=1e-15, rtol=1e-15)
        if turns @ x < 0 < turns @ end:
            lowest = brentq(slope, 0.0, length, xtol=1e-15)
            # a double zero at the start is no minimum
            if height(lowest) < (-1e-9 * size if fresh else 0.0):
                return brentq(height, low, lowest, xtol=1e-15, rtol=1e-15)
        return None
