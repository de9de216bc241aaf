"""Chords between points of lines: what their tangents say of the lines beside them."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


Indices = NDArray[np.int64]


Mark = Callable[[Vector, Vector], Vector]
"""Places and slopes there → what jumps from one branch of a function to another."""


def split(chords: Indices, middle: Indices) -> Indices:
    """The halves of chords, one pair after the other."""
    return np.stack([chords[:, 0], middle, middle, chords[:, 1]], axis=1).reshape(-1, 2)


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross products of pairs of vectors in the plane."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def cubic(at: Vector, slopes: Vector) -> Vector:
    """Height over a chord, in its lengths, of the cubic with some slopes at its ends."""
    return np.asarray(at * (1.0 - at) * ((1.0 - at) * slopes[:, 0] - at * slopes[:, 1]))


class Chords:
    """Points of lines, and chords between them given by the indices of both.

    Attributes:
        place: (points, 2).
        slope: derivatives of the function, (points, 2); NaN at a corner, where two branches meet.
        mark: of the points where it was asked for, else NaN.
        jump: of the mark, from one branch to another.
    """

    def __init__(self, mark: Mark, jump: float) -> None:
        self.place, self.slope = np.empty((0, 2)), np.empty((0, 2))
        self.mark, self._mark, self.jump = np.empty(0), mark, jump

    def jumps(self, chords: Indices) -> Any:
        """Return whether chords join two branches, as far as the marks of their ends are known."""
        return np.abs(np.diff(self.mark[chords], axis=1)[:, 0]) > self.jump

    def bent(self, chords: Indices) -> Vector:
        """Return the distance of a cubic from a chord of one branch: the third
        power of its turn.
        """
        slopes = self.slopes(chords)[2]
        turn = np.abs(slopes).max(axis=1)
        # error of the tangents, over the turn of a chord
        rough = 1e-6
        # a curvature that changes along the chord adds to it
        skew = 0.08 * slopes.sum(axis=1) ** 2 / np.maximum(turn, rough)
        # area beside a chord of one arc, over its length squared and the cube of its turn
        return np.asarray(0.6 * self.length(chords) ** 2 * (turn**3 + skew + rough))

    def marks(self, points: Indices) -> Vector:
        """Return the quantities that tell branches apart, at some points."""
        new = np.unique(points[np.isnan(self.mark[points])])
        self.mark[new] = self._mark(self.place[new], self.slope[new])
        return np.asarray(self.mark[points])

    def length(self, chords: Indices) -> Vector:
        """Return the length of each chord."""
        return np.asarray(
            np.linalg.norm(np.diff(self.place[chords], axis=1)[:, 0], axis=1)
        )

    def slopes(self, chords: Indices) -> tuple[Vector, Vector, Vector]:
        """Chords as vectors, those to their left, and slopes of the lines at both ends."""
        chord = np.diff(self.place[chords], axis=1)
        left = np.stack([-chord[..., 1], chord[..., 0]], axis=-1)
        # the line goes where the slope is turned to, clockwise
        forward, aside = (
            (self.slope[chords] * way).sum(axis=-1) for way in (left, -chord)
        )
        # largest slope over a chord in the area beside it: steeper tangents tell nothing about
        # the area
        steepest = 3.0
        with np.errstate(all="ignore"):
            slopes = np.clip(aside / np.maximum(forward, 0.0), -steepest, steepest)
        return chord[:, 0], left[:, 0], np.nan_to_num(slopes)

    def meeting(self, chords: Indices) -> tuple[Vector, Vector]:
        """Return where the tangent at the first end, forwards, meets that at the last, backwards.

        Returns:
            The share of its way from end to end, 0.5 where there is none, and the place, NaN there.
        """
        chord = np.diff(self.place[chords], axis=1)[:, 0]
        first, last = self.tangents(chords)
        with np.errstate(all="ignore"):
            along = cross(chord, last) / cross(first, last)
            back = cross(first, chord) / cross(first, last)
            share = np.where(
                (along > 0.0) & (back > 0.0), along / (along + back), np.nan
            )
        meeting = np.where(np.isnan(share), np.nan, along)[:, None] * first
        return np.nan_to_num(share, nan=0.5), self.place[chords[:, 0]] + meeting

    def tangents(self, chords: Indices) -> Vector:
        """Unit vectors along the lines at both ends, (2, chords, 2)."""
        slope = np.moveaxis(self.slope[chords], 1, 0)
        with np.errstate(invalid="ignore"):  # no tangent where there is no slope
            slope = slope / np.linalg.norm(slope, axis=-1)[..., None]
        return np.stack([slope[..., 1], -slope[..., 0]], axis=-1)
