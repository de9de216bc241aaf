"""All values of one parameter at which steady sliding of a structure is linearly stable.

Idea: every eigenvalue s of M s² + C s + K is followed along the parameter by its exact derivative
s′ = −wᵀ(M′s² + C′s + K′)v / wᵀ(2sM + C)v, with right and left eigenvectors v and w (Lancaster,
1964). Between two values the eigenvalues of both are paired so that the tangents of each pair meet
in the middle, which carries them through crossings. A step is done where some mode surely grows all
along, or surely none does, by the cubic that has values and slopes of both ends; it is halved
otherwise, also where contacts open or close and where two modes merge, whose slopes have no bound.

A reduced structure is held in modes of its own at each value; for slopes those of the values around
are turned into those of the value itself (Procrustes), since signs and order of modes are chance.

Invariant: a boundary is bracketed by computed eigenvalues before it is located, whatever the cubics
say. Stretches narrower than the finest step are missed.
Cost: three linearizations and one dense eigenvalue problem of 2n for each value; 30 to 300 values.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg as la
from scipy.optimize import linear_sum_assignment

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.linearized import pencil_about
from squealpipe.structures.modes import modal_damping_of
from squealpipe.structures.sliding import NoSlidingError, steady_sliding
from squealpipe.systems.inputs.values import brief
from squealpipe.vibration.boundaries import QuietInterval


@dataclass(frozen=True)
class Following:
    """Thresholds of the search; each comment says what another value would do."""

    finest: float = 1e-3
    """Narrowest step, over the first one. Half as much: narrower stretches are seen, one halving
    more at each boundary."""
    located: float = 1e-12
    """Width to which a boundary is located, over the value; more would show in printed digits."""
    round_off: float = 1e-13
    """Growth over the largest eigenvalue up to which a mode does not grow. Ten times as much: modes
    that grow so slowly count as stable; a tenth: round-off counts as growth."""
    undamped: float = 1e-9
    """Such a growth without damping, where modes lose half of their digits as they merge."""
    difference: float = 1e-3
    """Change of the parameter, over the first step, whose effect on the matrices gives their
    slopes, with errors of its square. Twice as much: 4 times the error; half: more round-off."""
    doubt: float = 2.0
    """Distance of two cubics from the true path, over that of their tangents in the middle."""


class _Linear(NamedTuple):
    """Matrices of small motions about steady sliding, and which contacts are closed there.

    Attributes:
        modes: of a reduced structure, amplitudes → displacements.
    """

    parts: np.ndarray
    closed: bytes
    modes: np.ndarray | None

    def along(self, other: _Linear) -> np.ndarray:
        """Return the matrices in the modes of another value."""
        if self.modes is None or other.modes is None:
            return self.parts
        turn, _ = la.orthogonal_procrustes(self.modes, other.modes)
        return np.asarray(turn.T @ self.parts @ turn)


class _Node:
    """Eigenvalues and their slopes at one value.

    Attributes:
        values: (2 n,), 1/s.
        slopes: by the parameter.
    """

    def __init__(
        self, at: float, linear: _Linear, slopes_of_parts: np.ndarray, band: float
    ) -> None:
        self.at, self.closed, self.band = at, linear.closed, band
        mass, damping, stiffness = linear.parts
        size = len(mass)
        # in units in which frequencies are about 1, so that both halves of a vector count alike
        unit = np.sqrt(np.linalg.norm(stiffness) / np.linalg.norm(mass)) or 1.0
        self._is_damped = bool(damping.any())
        solved = la.solve(mass, np.hstack([stiffness / unit, damping]), assume_a="pos")
        first = np.block([[np.zeros((size, size)), unit * np.eye(size)], [-solved]])
        self.values, left, right = la.eig(first, left=True)
        shapes = right[:size]
        # the lower half of a left vector of the linear form, by the mass, is one of the pencil
        duals = la.solve(mass, left[size:].conj(), assume_a="pos").T
        s = self.values[:, None]
        change, moved = (
            np.einsum("ji,jik,kj->j", duals, form, shapes)
            for form in (
                _quadratic(slopes_of_parts, s),
                2.0 * s[:, :, None] * mass + damping,
            )
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            slopes = -change / moved
        self.slopes = np.where(np.isfinite(slopes), slopes, np.inf)

    @cached_property
    def limit(self) -> float:
        """Growth that is round-off, 1/s."""
        share = Following.round_off if self._is_damped else Following.undamped
        return share * float(np.abs(self.values).max())

    @property
    def grows(self) -> bool:
        """Tell whether any mode within the band grows."""
        within = np.abs(self.values.imag) <= self.band
        return bool((self.values.real[within] > self.limit).any())


def _quadratic(parts: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return M s² + C s + K for each s, (values, n, n)."""
    mass, damping, stiffness = parts
    s = s[:, :, None]
    return np.asarray(mass * s**2 + damping * s + stiffness)


def linear_intervals(
    structure_at: Callable[[float], ContactStructure],
    values: Sequence[float],
    now: float,
    band: float = np.inf,
) -> list[QuietInterval]:
    """Return all stretches of a parameter in which steady sliding exists and no mode grows.

    Args:
        structure_at: structure of few degrees of freedom with a value of the parameter.
        values: ends of the steps that are looked at first, ascending: the first and the last are
            the range; contacts that open and close again within a step may be missed.
        now: present value.
        band: angular frequency up to which modes count, rad/s: truncated coordinates make modes
            beyond it grow that decay in the whole.

    Returns:
        Intervals, the nearest to the present value first. Ends at which the range ends, and not
        the quiet, are open.
    """
    search = _Search(structure_at, values, band)
    low, high = values[0], values[-1]
    intervals = [
        QuietInterval(begin, end, low_open=begin == low, high_open=end == high)
        for begin, end in pairwise(search.boundaries())
        if not search.grows(0.5 * (begin + end))
    ]
    return sorted(intervals, key=lambda one: one.distance(now))


class _Search:
    """Search of one range for the values where the first mode begins to grow or the last stops."""

    def __init__(
        self,
        structure_at: Callable[[float], ContactStructure],
        values: Sequence[float],
        band: float,
    ) -> None:
        self.structure_at, self.band = structure_at, band
        self.stations = [float(value) for value in values]
        if len(values) < 2 or not (np.diff(values) > 0).all():
            raise ValueError(
                f"values = {brief(values)}: at least two, ascending, are needed"
            )
        self.linear = lru_cache(maxsize=None)(self._linear)
        self.node = lru_cache(maxsize=None)(self._node)

    def _linear(self, at: float) -> _Linear | None:
        structure = self.structure_at(at)
        try:
            state = steady_sliding(structure, structure.mu, structure.belt_speed)
        except NoSlidingError:
            return None
        pencil = pencil_about(structure, state, modal_damping_of(structure))
        return _Linear(np.array(pencil.dense), state.piece.tobytes(), structure.modes)

    def _node(self, at: float) -> _Node | None:
        linear = self.linear(at)
        if linear is None:
            return None
        return _Node(at, linear, self._slopes(at, linear), self.band)

    def _first_step(self, at: float) -> float:
        """Return the length of the first step in which a value lies."""
        place = int(np.searchsorted(self.stations[1:-1], at))
        return self.stations[place + 1] - self.stations[place]

    def _slopes(self, at: float, linear: _Linear) -> np.ndarray:
        """Return derivatives of the matrices, from values where the same contacts are closed."""
        step = Following.difference * self._first_step(at)
        low, high = self.stations[0], self.stations[-1]
        for _ in range(4):  # at a contact that opens there is no slope
            # at an end of the range, and where a contact opens, differences are one-sided
            for offsets in ((-1.0, 1.0), (1.0, 2.0), (-1.0, -2.0)):
                places = [at + offset * step for offset in offsets]
                if not (low <= min(places) and max(places) <= high):
                    continue
                around = [self.linear(place) for place in places]
                if all(each and each.closed == linear.closed for each in around):
                    one, other = (each.along(linear) for each in around if each)
                    if offsets[0] == -offsets[1]:
                        return np.asarray((other - one) / (2.0 * step))
                    slope = (4.0 * one - other - 3.0 * linear.parts) / (2.0 * step)
                    return np.asarray(offsets[0] * slope)
            step *= 0.03
        return np.zeros_like(linear.parts)

    def grows(self, at: float) -> bool:
        """Tell whether a mode grows, or there is no steady sliding."""
        node = self.node(at)
        return node is None or node.grows

    def boundaries(self) -> list[float]:
        """Return the values at which the answer changes, and both ends of the range."""
        passed = [self.stations[0]]
        steps = [*pairwise(self.stations)][::-1]
        while steps:
            a, b = steps.pop()
            changes = self.grows(a) != self.grows(b)
            is_finest = b - a <= Following.finest * self._first_step(b)
            if self._is_sure(a, b, changes) or is_finest:
                if changes:
                    passed.append(self._located(a, b))
                continue
            middle = 0.5 * (a + b)
            steps += [(middle, b), (a, middle)]
        return [*passed, self.stations[-1]]

    def _located(self, a: float, b: float) -> float:
        """Return where the answer changes, by halving: growth may jump, or leave zero as a root."""
        grows = self.grows(b)
        least = Following.finest * self._first_step(b)  # next to 0
        while b - a > Following.located * max(abs(a), abs(b), least):
            middle = 0.5 * (a + b)
            if middle in (a, b):
                break
            if self._grows_quickly(middle) == grows:
                b = middle
            else:
                a = middle
        return a if grows else b

    def _grows_quickly(self, at: float) -> bool:
        """Tell the same as :meth:`grows` without slopes, which locating does not need."""
        linear = self.linear(at)
        if linear is None:
            return True
        none = np.zeros_like(linear.parts)
        return _Node(at, linear, none, self.band).grows

    def _is_sure(self, a: float, b: float, changes: bool) -> bool:
        """Tell whether the answer is that of both ends all along, or changes once."""
        one, other = self.node(a), self.node(b)
        if one is None and other is None:
            # no steady sliding: what lies between is looked at in a few places alone
            return b - a <= 0.25 * self._first_step(b)
        if one is None or other is None or one.closed != other.closed:
            return False
        paths = _Paths.between(one, other)
        if changes:
            return paths.changes_once
        return paths.some_grows if one.grows else paths.none_grows


@dataclass(frozen=True)
class _Paths:
    """Cubics of paired eigenvalues between two values, (places, modes), and what they may be off.

    Attributes:
        values: at places of the step, both ends included.
        off: bound of the distance from the true path, (modes,).
        limit: growth that is round-off.
        is_within: mask of the modes that are within the band all along; those that never are do not
            count and are left out.
    """

    values: np.ndarray
    off: np.ndarray
    limit: float
    is_within: np.ndarray

    @classmethod
    def between(cls, one: _Node, other: _Node) -> _Paths:
        """Pair the eigenvalues so that their tangents meet in the middle."""
        step = other.at - one.at
        ahead = one.values + 0.5 * step * one.slopes
        back = other.values - 0.5 * step * other.slopes
        with np.errstate(invalid="ignore"):
            apart = np.abs(ahead[:, None] - back[None, :])
        most = 10.0 * float(np.abs(one.values).max() + np.abs(other.values).max())
        apart = np.where(np.isfinite(apart), apart, most)
        rows, columns = linear_sum_assignment(apart)
        t = np.linspace(0.0, 1.0, 17)[:, None]
        start, end = one.values[rows], other.values[columns]
        first, last = (
            np.where(np.isfinite(each), each, 0.0)
            for each in (step * one.slopes[rows], step * other.slopes[columns])
        )
        cubic = (
            start * (1 + 2 * t) * (1 - t) ** 2
            + end * t**2 * (3 - 2 * t)
            + first * t * (1 - t) ** 2
            - last * t**2 * (1 - t)
        )
        off = Following.doubt * apart[rows, columns]
        counts = (np.abs(cubic.imag) - off <= one.band).any(axis=0)
        cubic, off = cubic[:, counts], off[counts]
        is_within = (np.abs(cubic.imag) + off <= one.band).all(axis=0)
        return cls(cubic, off, max(one.limit, other.limit), is_within)

    @property
    def growth(self) -> Any:
        """Growth along the step, (places, modes)."""
        return self.values.real

    @property
    def some_grows(self) -> bool:
        """Tell whether one mode surely grows all along."""
        grows = self.growth.min(axis=0) - self.off > self.limit
        return bool((grows & self.is_within).any())

    @property
    def _stays(self) -> np.ndarray:
        """Mask of the modes that surely do not grow anywhere."""
        falls = self.growth.max(axis=0) + self.off <= 0.0
        return np.asarray(falls | self._is_still)

    @property
    def _is_still(self) -> np.ndarray:
        """Mask of undamped modes that stay apart from one another, so that none can merge."""
        still = (np.abs(self.growth) <= self.limit).all(axis=0)
        if not still.any():
            return np.asarray(still)
        frequencies = self.values.imag
        for mode in np.flatnonzero(still):
            gaps = np.abs(frequencies[:, mode, None] - frequencies).min(axis=0)
            gaps[mode] = np.inf
            if not (gaps > 2.0 * (self.off + self.off[mode]) + self.limit).all():
                still[mode] = False
        return np.asarray(still)

    @property
    def none_grows(self) -> bool:
        """Tell whether surely no mode grows anywhere."""
        return bool(self._stays.all())

    @property
    def changes_once(self) -> bool:
        """Tell whether surely one mode, or a pair of conjugates, passes zero once."""
        moving = np.flatnonzero(~self._stays)
        if not moving.size or moving.size > 2:
            return False
        rates = np.diff(self.growth[:, moving], axis=0)
        is_monotonic = (rates > 0).all(axis=0) | (rates < 0).all(axis=0)
        # beside the whole way the doubt is small, so that the true path turns no more than this one
        way = np.abs(self.growth[-1, moving] - self.growth[0, moving])
        return bool((is_monotonic & (self.off[moving] < 0.1 * way)).all())
