"""How far an undamped linear motion from rest can go, ever: bounds from its two modes.

With A = λ1 P1 + λ2 P2 the motion is u* − Σ cos(ω_i t) P_i u*, so each coordinate stays within
its equilibrium plus and minus the sum of its modal amplitudes, whatever the time. Of a smooth
nonlinear system :func:`motion_about` gives that motion about the equilibrium proper, and by how
much the quadratic part of the force moves it, to second order in the amplitudes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

Field = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]
"""(x, y) → acceleration, m/s²; analytic, so that it takes complex numbers."""

NEWTON_STEPS = 12
LARGEST_STEP = 2.0
"""Largest step of Newton's method, in the system's length."""
SETTLED = 1e-9
"""Last step of a Newton method that has converged, likewise."""
COMPLEX_STEP = 1e-30
DIFFERENCE = 1e-4
"""Step of the second derivative, in modal amplitudes: its error is of the square of this."""


class ModalMotion(NamedTuple):
    """Both coordinates of a motion from rest; all arrays of one shape, modes on the last axis.

    Attributes:
        oscillates: whether both λ are real and positive; the rest holds only there.
        omega: (…, 2) angular frequencies, ascending, rad/s.
        rest: (…, 2) equilibrium (x, y), m.
        x_mode, y_mode: (…, 2) amplitude of each mode, signed, m.
    """

    oscillates: np.ndarray
    omega: np.ndarray
    rest: np.ndarray
    x_mode: np.ndarray
    y_mode: np.ndarray

    def highest(self) -> np.ndarray:
        """Bound above all y, m."""
        return np.asarray(self.rest[..., 1] + np.abs(self.y_mode).sum(axis=-1))

    def lowest(self) -> np.ndarray:
        """Bound below all y, m."""
        return np.asarray(self.rest[..., 1] - np.abs(self.y_mode).sum(axis=-1))

    def farthest(self) -> np.ndarray:
        """Bound on √(x² + y²), m: the distance is convex, so largest at a corner ±z1 ± z2."""
        signs = np.array([-1.0, 1.0])
        x, y = (
            rest[..., None, None]
            + mode[..., :1, None] * signs[:, None]
            + mode[..., 1:, None] * signs
            for rest, mode in zip(
                np.moveaxis(self.rest, -1, 0), (self.x_mode, self.y_mode), strict=True
            )
        )
        return np.asarray(np.hypot(x, y).max(axis=(-2, -1)))

    def fastest(self) -> np.ndarray:
        """Bound on |ẋ|, m/s."""
        return np.asarray((self.omega * np.abs(self.x_mode)).sum(axis=-1))

    def positions(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(x, y) at the times, (…, n) each, m."""
        first, second = (np.cos(self.omega[..., mode, None] * times) for mode in (0, 1))
        return (
            self.rest[..., :1] + self.x_mode[..., :1] * first + self.x_mode[..., 1:] * second,
            self.rest[..., 1:] + self.y_mode[..., :1] * first + self.y_mode[..., 1:] * second,
        )


def modal_motion(
    matrix: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    squared: tuple[np.ndarray, np.ndarray],
    rest: tuple[np.ndarray, np.ndarray],
) -> ModalMotion:
    """The motion from rest at the origin of ü = −A (u − u*).

    Args:
        matrix: (a11, a12, a21, a22) of A, 1/s².
        squared: its eigenvalues ω1², ω2², complex, ascending.
        rest: u* = (x*, y*), m.
    """
    a11, a12, a21, a22 = matrix
    first, second = squared
    with np.errstate(divide="ignore", invalid="ignore"):
        oscillates = (first.imag == 0) & (first.real > 0) & (second.real > first.real)
        w1, w2 = (
            np.where(oscillates, value.real, 1.0 + index) for index, value in enumerate(squared)
        )
        x_rest, y_rest = (np.where(oscillates, value, 0.0) for value in rest)
        # P1 = (A − λ2)/(λ1 − λ2), P2 = 1 − P1; the motion starts at −u* from its equilibrium
        x1 = -((a11 - w2) * x_rest + a12 * y_rest) / (w1 - w2)
        y1 = -(a21 * x_rest + (a22 - w2) * y_rest) / (w1 - w2)
    return ModalMotion(
        oscillates=oscillates,
        omega=np.sqrt(np.stack([w1, w2], axis=-1)),
        rest=np.stack([x_rest, y_rest], axis=-1),
        x_mode=np.stack([x1, -x_rest - x1], axis=-1),
        y_mode=np.stack([y1, -y_rest - y1], axis=-1),
    )


class SecondOrder(NamedTuple):
    """A motion from rest of a nonlinear system, about its equilibrium.

    Attributes:
        motion: the linear motion about the equilibrium; where Newton's method found none, it
            does not oscillate.
        shift: (…, 2) bound on what the quadratic force adds to x and to y, m.
        exchange: the share of the slower mode that the difference tone ω2 − ω1 adds to it. Near
            ω2 = 2 ω1 the faster mode feeds the slower one, however small that one is: about 1 at
            the edge of Mathieu's tongue.
    """

    motion: ModalMotion
    shift: np.ndarray
    exchange: np.ndarray


def motion_about(field: Field, shape: tuple[int, ...], length: np.ndarray) -> SecondOrder:
    """The motion from rest at the origin to second order, with derivatives by complex steps.

    With z_i the amplitude vector of mode i and q the quadratic part of the force, mode i is
    driven by q(z_j, z_k) at the frequencies 0, 2ω1, 2ω2 and ω2 ± ω1. A force F cos Ωt from rest
    moves it by F (cos Ωt − cos ω_i t)/(ω_i² − Ω²), at most 2|F|/|ω_i² − Ω²|; the sum of these is
    the shift. It is infinite at the resonance ω2 = 2ω1.

    Args:
        field: acceleration at (x, y) of ``shape``.
        shape: of the cells.
        length: scale of the motion, m, of that shape.
    """
    x, y = np.zeros(shape), np.zeros(shape)
    step = np.full(shape, np.inf)
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            a11, a12, a21, a22 = _stiffness(field, x, y, length)
            fx, fy = field(x, y)
            determinant = a11 * a22 - a12 * a21
            dx, dy = (a22 * fx - a12 * fy) / determinant, (a11 * fy - a21 * fx) / determinant
            step = np.hypot(dx, dy) / length
            limited = np.minimum(1.0, LARGEST_STEP / np.maximum(step, SETTLED))
            x, y = np.nan_to_num(x + limited * dx), np.nan_to_num(y + limited * dy)
            if (step <= SETTLED).all():
                break
        a11, a12, a21, a22 = _stiffness(field, x, y, length)
        half_trace, half_difference = 0.5 * (a11 + a22), 0.5 * (a11 - a22)
        root = np.sqrt((half_difference * half_difference + a12 * a21).astype(complex))
        larger = half_trace + root
        smaller = (a11 * a22 - a12 * a21) / larger
        # what has not settled gets a complex pair, which does not oscillate
        smaller = np.where(step <= SETTLED, smaller, 1j)
    motion = modal_motion((a11, a12, a21, a22), (smaller, larger), (x, y))
    return SecondOrder(motion, *_shift(field, motion, (a11, a12, a21, a22)))


def _stiffness(
    field: Field, x: np.ndarray, y: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(a11, a12, a21, a22) of minus the field's derivative, 1/s²."""
    step = COMPLEX_STEP * length
    along_x, along_y = field(x + 1j * step, y + 0j), field(x + 0j, y + 1j * step)
    return (
        -along_x[0].imag / step, -along_y[0].imag / step,
        -along_x[1].imag / step, -along_y[1].imag / step,
    )  # fmt: skip


def _shift(
    field: Field,
    motion: ModalMotion,
    matrix: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Sum of the largest responses at all combination frequencies, (…, 2), and the exchange."""
    x, y = motion.rest[..., 0], motion.rest[..., 1]
    modes = [(motion.x_mode[..., i], motion.y_mode[..., i]) for i in (0, 1)]

    def quadratic(first: int, second: int) -> tuple[np.ndarray, np.ndarray]:
        """Half the second derivative of the field along two modes."""
        (ux, uy), (vx, vy) = modes[first], modes[second]
        h, d = COMPLEX_STEP, DIFFERENCE
        above = field(x + d * ux + 1j * h * vx, y + d * uy + 1j * h * vy)
        below = field(x - d * ux + 1j * h * vx, y - d * uy + 1j * h * vy)
        return tuple((a.imag - b.imag) / (4.0 * h * d) for a, b in zip(above, below, strict=True))  # type: ignore[return-value]

    w1, w2 = motion.omega[..., 0], motion.omega[..., 1]
    still = np.zeros(np.shape(w1))
    q11, q22, q12 = quadratic(0, 0), quadratic(1, 1), quadratic(0, 1)
    difference = w2 - w1
    driven = [
        (q11, 0.5, still), (q11, 0.5, 2.0 * w1), (q22, 0.5, still), (q22, 0.5, 2.0 * w2),
        (q12, 1.0, w2 + w1), (q12, 1.0, difference),
    ]  # fmt: skip
    a11, a12, a21, a22 = matrix
    total = np.zeros((*np.shape(w1), 2))
    with np.errstate(all="ignore"):
        slower, faster = w1 * w1, w2 * w2
        for own, other in ((slower, faster), (faster, slower)):
            for (fx, fy), weight, frequency in driven:
                # the share of this mode: (A − λ_other)/(λ_own − λ_other) times the force
                part = (
                    np.stack(
                        [(a11 - other) * fx + a12 * fy, a21 * fx + (a22 - other) * fy], axis=-1
                    )
                    / (own - other)[..., None]
                )
                distance = np.abs(own - frequency * frequency)[..., None]
                response = 2.0 * weight * np.abs(part) / distance
                total += response
                if own is slower and frequency is difference:
                    (ux, uy), size = modes[0], np.linalg.norm(response, axis=-1)
                    exchange = np.where(size > 0.0, size / np.hypot(ux, uy), 0.0)
    return (
        np.where(motion.oscillates[..., None], total, np.inf),
        np.where(motion.oscillates, exchange, np.inf),
    )
