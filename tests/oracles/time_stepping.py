"""Contacts on a belt by time steps alone: nothing is located, no regime is named.

Damped modes at rest turn exactly through half a step; then the contacts kick the velocities once: a
spring that only presses, and Coulomb friction as a projection on −μN ≤ T ≤ μN, by Gauss-Seidel over
the contacts (Moreau 1988; Jean 1999). Errors fall with the step.
"""

from typing import NamedTuple

import numba
import numpy as np
import scipy.linalg as la


class Stepped(NamedTuple):
    """What a run shows.

    Attributes:
        q, v: state at its end, (n,).
        velocities: of the structure at equal intervals, (samples, n).
        separated, stuck: shares of the steps, (contacts,).
    """

    q: np.ndarray
    v: np.ndarray
    velocities: np.ndarray
    separated: np.ndarray
    stuck: np.ndarray


class TimeStepping:
    """A structure of constant friction, in modes at rest, in which its damping is diagonal."""

    def __init__(self, structure):
        springs = structure.stiffnesses
        self.stiffness, self.preload = springs, structure.preloads
        mass = structure.mass.toarray()
        at_rest = structure.stiffness.toarray()
        at_rest += (structure.normals * springs) @ structure.normals.T
        square, self.shapes = la.eigh(at_rest, mass)
        self.omega = np.sqrt(square)
        damping = self.shapes.T @ structure.damping.toarray() @ self.shapes
        self.ratio = structure.modal_damping + np.diag(damping) / (2.0 * self.omega)
        assert np.allclose(
            damping, np.diag(np.diag(damping)), atol=1e-9 * damping.max()
        )
        self.to_modes = self.shapes.T @ mass
        self.normals = np.ascontiguousarray(self.shapes.T @ structure.normals)
        self.tangentials = np.ascontiguousarray(self.shapes.T @ structure.tangentials)
        self.belt = structure.speeds * structure.belt_speed
        self.mu = structure.mu_of_contacts
        self.load = self.shapes.T @ structure.load

    def half_step(self, step):
        """Turn each mode about its static deflection: six numbers each, (n, 6)."""
        decay, turn = self.ratio * self.omega, self.omega * np.sqrt(1 - self.ratio**2)
        cos, sin = np.cos(turn * step / 2), np.sin(turn * step / 2)
        gone = np.exp(-decay * step / 2)
        qq, qv = gone * (cos + decay / turn * sin), gone * sin / turn
        vq, vv = -gone * self.omega**2 / turn * sin, gone * (cos - decay / turn * sin)
        still = self.load / self.omega**2
        return np.stack([qq, qv, still - qq * still, vq, vv, -vq * still], axis=1)

    def run(self, state, step, samples, steps_between):
        """Step on from a state (2 n,)."""
        n = len(self.omega)
        q, v = self.to_modes @ state[:n], self.to_modes @ state[n:]
        velocities = np.empty((samples, n))
        counts = np.zeros((2, len(self.belt)))
        _run(
            q,
            v,
            step,
            steps_between,
            self.half_step(step),
            (self.normals, self.tangentials, self.stiffness, self.preload),
            (self.belt, self.mu),
            self.tangentials.T @ np.hstack([self.tangentials, self.normals]),
            velocities,
            counts,
        )
        separated, stuck = counts / (samples * steps_between)
        return Stepped(
            self.shapes @ q,
            self.shapes @ v,
            velocities @ self.shapes.T,
            separated,
            stuck,
        )


@numba.njit
def _run(q, v, step, between, half, contacts, belts, answers, velocities, counts):
    normals, tangentials, stiffness, preload = contacts
    belt, mu = belts
    for place in range(velocities.shape[0] * between):
        _turn(q, v, half)
        lift, speed = np.zeros(len(belt)), np.zeros(len(belt))
        for i in range(len(q)):
            for j in range(len(belt)):
                lift[j] += normals[i, j] * q[i]
                speed[j] += tangentials[i, j] * v[i]
        force = preload - stiffness * lift
        # the modes hold the springs of all contacts, those that are open among them
        push = np.where(force > 0.0, preload, stiffness * lift)
        limit = mu * np.maximum(force, 0.0)
        friction = np.sign(belt - speed) * limit
        _slide(belt - speed, friction, push, limit, step, answers)
        counts[0] += force <= 0.0
        counts[1] += np.abs(friction) < limit * (1.0 - 1e-9)
        for i in range(len(q)):
            for j in range(len(belt)):
                kick = normals[i, j] * push[j] + tangentials[i, j] * friction[j]
                v[i] += step * kick
        _turn(q, v, half)
        if (place + 1) % between == 0:
            velocities[(place + 1) // between - 1] = v


@numba.njit
def _turn(q, v, half):
    for i in range(len(q)):
        x = half[i, 0] * q[i] + half[i, 1] * v[i] + half[i, 2]
        v[i] = half[i, 3] * q[i] + half[i, 4] * v[i] + half[i, 5]
        q[i] = x


@numba.njit
def _slide(sliding, friction, push, limit, step, answers):
    """Lower friction until none acts along the sliding behind the kick."""
    c = len(sliding)
    for j in range(c):
        for k in range(c):
            change = answers[j, k] * friction[k] + answers[j, c + k] * push[k]
            sliding[j] -= step * change
    for _ in range(50):
        moved = 0.0
        for j in range(c):
            if abs(friction[j]) == limit[j] and sliding[j] * friction[j] >= 0.0:
                continue
            wanted = friction[j] + sliding[j] / (step * answers[j, j])
            change = min(max(wanted, -limit[j]), limit[j]) - friction[j]
            friction[j] += change
            moved = max(moved, abs(change) / limit[j])
            for k in range(c):
                sliding[k] -= step * answers[k, j] * change
        if moved < 1e-12:
            return
