"""Cosine coefficients of the contact gap max(threshold − y, 0) of an even series y(θ).

In closed form between located contact times, or from samples (alternating frequency–time).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.laws.contact import smoothed_compression, smoothed_compression_slope
from squealpipe.systems.zeros import bracketed
from squealpipe.vibration.parabola import vertex

Vector = NDArray[np.float64]


def contact_angles(
    cosine: Vector, threshold: float, grid: Vector, table: Vector
) -> Vector:
    """Zeros of threshold − y(θ) in (0, π), ascending, to machine precision.

    A touch that stays between two grid points is found from the parabola through its
    neighbours, so a short contact or flight is not lost.
    """
    gap = threshold - table @ cosine
    above = gap > 0.0
    edges = np.flatnonzero(above[1:] != above[:-1])
    brackets = np.stack([grid[edges], grid[edges + 1], gap[edges], gap[edges + 1]])
    dips = _hidden_dips(gap, above, grid)
    if dips.size:
        bottom = threshold - np.cos(np.outer(dips, np.arange(len(cosine)))) @ cosine
        after = np.searchsorted(grid, dips)
        deep = (bottom > 0.0) != above[after - 1]
        dips, bottom, after = dips[deep], bottom[deep], after[deep]
        before = np.stack([grid[after - 1], dips, gap[after - 1], bottom])
        beyond = np.stack([dips, grid[after], bottom, gap[after]])
        brackets = np.concatenate([brackets, before, beyond], axis=1)
        brackets = brackets[:, np.argsort(brackets[0])]
    order = np.arange(len(cosine))
    rate = order * cosine

    def gap_at(theta: Vector) -> tuple[Vector, Vector]:
        phase = np.outer(theta, order)
        return threshold - np.cos(phase) @ cosine, np.sin(phase) @ rate

    left, right, first, last = brackets
    # the square of Newton's last step, the error that is left, is below round-off
    return bracketed(gap_at, (left, right), (first, last), 1e-9)


def _hidden_dips(gap: Vector, above: NDArray[np.bool_], grid: Vector) -> Vector:
    """Return where a parabola through three neighbours on one side of the level crosses it."""
    size = np.abs(gap)
    inner = np.flatnonzero(
        (size[1:-1] <= size[:-2])
        & (size[1:-1] <= size[2:])
        & (above[1:-1] == above[:-2])
        & (above[1:-1] == above[2:])
    )
    if not inner.size:
        return np.empty(0)
    before, here, after = gap[inner], gap[inner + 1], gap[inner + 2]
    shift, lowest = vertex(before, here, after)
    crossing = (lowest * here <= 0.0) & (shift != 0.0)
    turns: Vector = grid[inner + 1] + shift * (grid[1] - grid[0])
    return np.asarray(turns[crossing])


@dataclass(frozen=True)
class ClosedFormContact:
    """Contact integrals in closed form: no sampling error.

    With W_k the integral of cos kθ over the contact intervals, the gap's coefficients are
    threshold·ε_n W_n/π − M y with M_nm = ε_n (W_|n−m| + W_n+m)/2π, and −M is their exact
    Jacobian, because the gap vanishes at the intervals' ends.
    """

    n_harmonics: int
    threshold: float

    @cached_property
    def grid(self) -> Vector:
        """Angles between which contact times are looked for."""
        # eight samples for each harmonic show every dip
        return np.linspace(0.0, math.pi, max(32, 8 * self.n_harmonics) + 1)

    @cached_property
    def _table(self) -> Vector:
        return np.asarray(np.cos(np.outer(self.grid, np.arange(self.n_harmonics + 1))))

    @cached_property
    def _sums(self) -> tuple[NDArray[np.intp], NDArray[np.intp], Vector]:
        order = np.arange(self.n_harmonics + 1)
        weight = np.where(order == 0, 1.0, 2.0) / math.pi
        return np.abs(order[:, None] - order), order[:, None] + order, weight

    def angles(self, cosine: Vector) -> Vector:
        """Contact angles in (0, π), ascending."""
        return contact_angles(cosine, self.threshold, self.grid, self._table)

    def gap(self, cosine: Vector) -> tuple[Vector, Vector]:
        """Coefficients of the gap (n,) and their Jacobian (n, n)."""
        angles = self.angles(cosine)
        ends = np.concatenate([[0.0], angles, [math.pi]])
        # contact at θ = 0 means that the first interval counts, otherwise the second
        skip = 0 if cosine.sum() < self.threshold else 1
        begin, end = ends[skip:-1:2], ends[skip + 1 :: 2]
        multiple = np.arange(1, 2 * self.n_harmonics + 1)
        integral = np.empty(2 * self.n_harmonics + 1)
        integral[0] = (end - begin).sum()
        integral[1:] = (
            np.sin(np.outer(multiple, end)) - np.sin(np.outer(multiple, begin))
        ).sum(axis=1) / multiple
        difference, total, weight = self._sums
        matrix = (0.5 * weight)[:, None] * (integral[difference] + integral[total])
        gap = (
            self.threshold * weight * integral[: self.n_harmonics + 1] - matrix @ cosine
        )
        return gap, -matrix


@dataclass(frozen=True)
class SampledContact:
    """Contact force from N samples per period, sharp or smoothed by tanh: the paper's way.

    Attributes:
        threshold: level of y at which contact ends.
        n_time: N, at least 2 N_h + 1.
        sigma: regularizing factor of tanh(σ(threshold − y)); None: sharp.
    """

    n_harmonics: int
    threshold: float
    n_time: int
    sigma: float | None = None

    @cached_property
    def _tables(self) -> tuple[Vector, Vector]:
        """cos nθ on the half period, and the weights that turn samples into coefficients."""
        half = np.arange(self.n_time // 2 + 1)
        order = np.arange(self.n_harmonics + 1)
        table = np.cos(np.outer(2.0 * math.pi * half / self.n_time, order))
        share = (
            np.where((half == 0) | (2 * half == self.n_time), 1.0, 2.0) / self.n_time
        )
        return table, (table * share[:, None]).T * np.where(order == 0, 1.0, 2.0)[
            :, None
        ]

    @cached_property
    def _locator(self) -> ClosedFormContact:
        return ClosedFormContact(self.n_harmonics, self.threshold)

    def angles(self, cosine: Vector) -> Vector:
        """Contact angles in (0, π), ascending."""
        return self._locator.angles(cosine)

    def gap(self, cosine: Vector) -> tuple[Vector, Vector]:
        """Coefficients of the (smoothed) gap (n,) and their Jacobian (n, n)."""
        table, weights = self._tables
        distance = self.threshold - table @ cosine
        if self.sigma is None:
            compression = np.maximum(distance, 0.0)
            slope = (distance > 0.0).astype(float)
        else:
            compression = smoothed_compression(distance, self.sigma)
            slope = smoothed_compression_slope(distance, self.sigma)
        return weights @ compression, -(weights * slope) @ table
