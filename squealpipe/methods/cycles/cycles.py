"""Periodic motions of a hybrid system by Newton's method on the return map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.methods.cycles.event_flow import (
    HybridSystem,
    Passage,
    Segment,
    Vector,
    flow,
    sample_path,
    turning_points,
)

RESIDUAL = 1e-9
"""Largest accepted closing error, over the scales of the cycle."""
FAMILY = 1e-6
"""A second multiplier this close to 1 belongs to a family of cycles."""


@dataclass(frozen=True)
class Cycle:
    """A periodic motion.

    Attributes:
        system: the system that it belongs to.
        state: on the cycle, outside stick.
        period: its time.
        scale: of the state's components.
        residual: largest closing error over ``scale``.
        passage: once round, with the derivative and the motion between events.
    """

    system: HybridSystem
    state: Vector
    period: float
    scale: Vector
    residual: float
    passage: Passage

    @property
    def segments(self) -> list[Segment]:
        """The motion between events, once round."""
        return self.passage.segments

    @property
    def heading(self) -> Vector:
        """Velocity of the motion at ``state`` over ``scale`` and period."""
        velocity = self.system.velocity(self.passage.regimes[0], self.state)
        return velocity / self.scale * self.period

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers, the trivial one first, then by falling magnitude.

        The motion's own direction is mapped onto itself; split off, it leaves the others well
        conditioned where they meet 1, as at a fold.
        """
        matrix = self.passage.derivative * self.scale / self.scale[:, None]
        ahead = self.heading
        basis = np.linalg.qr(np.column_stack([ahead, np.eye(len(ahead))]))[0]
        turned = basis.T @ matrix @ basis
        rest = np.linalg.eigvals(turned[1:, 1:]).astype(np.complex128)
        # conjugates: positive imaginary part first
        order = sorted(
            range(len(rest)), key=lambda i: (-round(float(abs(rest[i])), 9), -rest[i].imag)
        )
        return np.concatenate([turned[:1, 0].astype(np.complex128), rest[order]])

    @cached_property
    def extent(self) -> Vector:
        """(lowest, highest) of each position over the cycle, shape (2, 2)."""
        places = [self.state, *self.passage.event_states]
        result = []
        for component in (0, 1):
            values = [float(place[component]) for place in places]
            values += [point.value for point in turning_points(self.segments, component)]
            result.append((min(values), max(values)))
        return np.array(result).T

    @property
    def closing_error(self) -> float:
        """Largest closing error over the cycle's own extent, which may be far below ``scale``."""
        path = sample_path(self.segments, np.linspace(0.0, self.period, 200))
        return float(np.abs((self.passage.state - self.state) / common_scale(path)).max())

    @property
    def is_family_member(self) -> bool:
        """Whether a second multiplier is 1 in a system whose cycles come in families."""
        near = np.abs(self.multipliers[1:] - 1.0).min() < FAMILY
        return bool(near and self.system.has_families)

    @property
    def is_stable(self) -> bool:
        """Whether all multipliers but the trivial one lie inside the unit circle."""
        return bool(np.abs(self.multipliers[1:]).max() < 1.0)

    @property
    def sequence(self) -> tuple[int, ...]:
        """Kinds of its events, from the rotation that sorts first."""
        kinds = tuple(self.passage.event_kinds)
        return min((kinds[i:] + kinds[:i] for i in range(len(kinds))), default=())


def common_scale(path: Vector) -> Vector:
    """Extent of a motion, (4,): one length for both positions, one speed for both velocities."""
    length, speed = np.ptp(path, axis=0).reshape(2, 2).max(axis=1)
    scale: Vector = np.maximum(np.array([length, length, speed, speed]), 1e-300)
    return scale


def multiplier_change(one: Cycle, other: Cycle) -> float:
    """Largest relative distance of a multiplier from the nearest of the other cycle."""
    first, second = one.multipliers, other.multipliers
    distance = np.abs(first[:, None] - second) / (1.0 + np.abs(first[:, None]))
    return float(max(distance.min(axis=0).max(), distance.min(axis=1).max()))


def find_returns(
    system: HybridSystem, state: Vector, longest: float, samples: int = 4000
) -> list[tuple[float, float]]:
    """(time, distance) of passes through the plane normal to the motion at ``state``.

    Distances are relative to the motion's extent. Passes near the smallest distance come first,
    the earliest of them before the others.
    """
    passage = flow(system, state, longest, derivative=False, keep=True)
    times = np.linspace(0.0, longest, samples)
    path = sample_path(passage.segments, times)
    scale = common_scale(path)
    normal = system.velocity(passage.regimes[0], state) / scale
    height = ((path - state) / scale) @ normal
    passes = np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0))
    share = -height[passes] / (height[passes + 1] - height[passes])
    there = path[passes] + share[:, None] * (path[passes + 1] - path[passes])
    distance = np.abs((there - state) / scale).max(axis=1)
    near = distance < 3.0 * distance.min(initial=np.inf) + 1e-6
    order = np.lexsort((times[passes], ~near))
    return [(float(times[passes][i] + share[i] * times[1]), float(distance[i])) for i in order]


def solve_cycle(
    system: HybridSystem, state: Vector, period: float, scale: Vector, max_iterations: int = 15
) -> Cycle | None:
    """Newton's method on φ_T(z) − z = 0 with dz normal to the motion at the guess.

    Where cycles come in families the equations are singular, and the smallest correction is taken.

    Args:
        system: the system.
        state, period: guess.
        scale: of the state's components.
        max_iterations: after which there is no cycle.
    """
    regime, state = system.start(np.asarray(state, dtype=np.float64))
    reference, time = state, period
    phase = system.velocity(regime, state) / scale
    phase = phase / np.linalg.norm(phase)
    best, previous = None, np.inf
    matrix, right = np.zeros((5, 5)), np.zeros(5)
    for _ in range(max_iterations):
        passage = flow(system, state, period, keep=True)
        if not passage.complete:
            return None
        error = (passage.state - state) / scale
        residual = float(np.abs(error).max())
        if not np.isfinite(residual) or residual > 1e3:
            return None
        if residual < previous:
            best = Cycle(system, state, period, scale, residual, passage)
        if (residual >= 0.5 * previous and previous < RESIDUAL) or residual < 1e-14:
            break
        previous = min(residual, previous)
        end = system.velocity(passage.regime, passage.state)
        matrix[:4, :4] = (passage.derivative - np.eye(4)) * scale / scale[:, None]
        matrix[:4, 4] = end / scale * time
        matrix[4, :4] = phase
        right[:4], right[4] = -error, -float(phase @ ((state - reference) / scale))
        step = np.linalg.lstsq(matrix, right, rcond=1e-9)[0]
        length = float(np.abs(step).max())
        step *= min(1.0, 0.3 / max(length, 1e-300))
        state, period = state + step[:4] * scale, period + step[4] * time
        if period <= 0.0:
            return None
    return None if best is None or best.residual > RESIDUAL else best
