"""Bounds on how far an undamped linear motion from rest can ever go, from its two modes.

With A = λ1 P1 + λ2 P2 the motion is u* − Σ cos(ω_i t) P_i u*, so each coordinate stays within
its equilibrium plus and minus the sum of its modal amplitudes, whatever the time.
"""

from typing import NamedTuple

import numpy as np


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
            self.rest[..., :1]
            + self.x_mode[..., :1] * first
            + self.x_mode[..., 1:] * second,
            self.rest[..., 1:]
            + self.y_mode[..., :1] * first
            + self.y_mode[..., 1:] * second,
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
            np.where(oscillates, value.real, 1.0 + index)
            for index, value in enumerate(squared)
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
