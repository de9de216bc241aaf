"""Exact symmetric periodic orbits and their branches, from compiled kernels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from enum import IntEnum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from squealpipe.codes import SpecialPoint
from squealpipe.methods.orbits import branch_steps, branch_tracing, shorter_orbits
from squealpipe.methods.orbits.modal_flow import propagator
from squealpipe.methods.orbits.orbit_shape import extremes
from squealpipe.methods.orbits.piecewise_linear import PiecewiseLinearSystem
from squealpipe.methods.orbits.shooting import (
    MAX_SEGMENTS,
    rest_conditions,
    shoot,
    solve_constrained,
    stability_index,
)
from squealpipe.methods.progress import report

_MOST_SPLITS = 6
_CLEAR = 1e-9
"""Below it a sign is left to round-off: where a tongue ends, the index tends to 2."""
_ROOM = 4.0
"""Over the bend of a measure between two points, least distance from zero that excludes a pair."""
_ROWS_PER_CALL = 512


class TraceEnd(IntEnum):
    """Why a trace ended, in the words of ``schema.Outcome``."""

    amplitude_reached = branch_steps.REACHED
    retraced = branch_steps.RETURNED
    tongue_end = branch_steps.TONGUE_END
    branch_lost = branch_steps.BRANCH_LOST
    step_limit = branch_steps.STEP_LIMIT
    pole = branch_steps.DIVERGED


@dataclass(frozen=True)
class TraceSettings:
    """Step control of a trace, in arclength over 1 + |z| of z = (x0, y0, T/2).

    Attributes:
        least_cosine: of the angle between branch directions before and after a step.
        strict: whether a step must keep the sense of the branch; without it a trace crosses
            narrow resonances, so it may leave its branch.
        largest_x: |x0| over y0 and the linear mode's x0 together, beyond which the branch
            follows an internal resonance to infinity.
        linear_x, linear_slope: |x0| of the linear mode at the threshold and its growth with y0.
    """

    first_step: float = 0.01
    longest_step: float = 0.1
    least_cosine: float = 0.98
    strict: bool = True
    max_points: int = 4000
    largest_x: float = 50.0
    linear_x: float = 0.0
    linear_slope: float = 0.0

    def control(self) -> NDArray[np.float64]:
        """All but the first step, as the compiled kernels read it."""
        return np.array(astuple(self)[1:], dtype=float)


@dataclass(frozen=True)
class Orbit:
    """A symmetric periodic orbit in the units of its system.

    Attributes:
        point: (3,) x0, y0, T/2, the orbit's state at rest with the larger y.
        stability_index: trace of the monodromy matrix − 2.
    """

    point: NDArray[np.float64]
    switches: NDArray[np.float64]
    stability_index: float
    residual: float

    @property
    def omega(self) -> float:
        """Angular frequency 2π/T."""
        return float(math.pi / self.point[2])

    def other_rest(self, system: PiecewiseLinearSystem) -> NDArray[np.float64]:
        """(2,) x and y after half a period, the other instant of rest."""
        final = np.empty(4)
        x0, y0, half_period = self.point
        work = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS)
        shoot(system.rows, x0, y0, half_period, *work, final)
        return final[:2]

    def from_higher_rest(self, system: PiecewiseLinearSystem) -> Orbit:
        """The same orbit, described from its instant of rest with the larger y."""
        final = self.other_rest(system)
        if final[1] <= self.point[1]:
            return self
        times = self.point[2] - self.switches[::-1]
        point = np.array([*final, self.point[2]])
        return Orbit(point, times, self.stability_index, self.residual)

    def largest_y(self, system: PiecewiseLinearSystem) -> float:
        """Largest y over the period."""
        out = np.empty(6)
        extremes(system.rows, np.ascontiguousarray(self.point, dtype=float), out)
        return float(out[3])


def solve_orbit(
    system: PiecewiseLinearSystem, guess: NDArray[np.float64]
) -> Orbit | None:
    """The orbit with the y0 of a guess (x0, y0, T/2), or None where Newton's method fails."""
    row, switches = np.empty(len(branch_tracing.COLUMNS)), np.empty(MAX_SEGMENTS)
    start = np.array(guess[:3], dtype=float)
    if not branch_tracing.orbit_at(system.rows, start, row, switches):
        return None
    return _orbit(row, switches)


def orbit_across(
    system: PiecewiseLinearSystem,
    guess: NDArray[np.float64],
    normal: NDArray[np.float64],
) -> Orbit | None:
    """The orbit on the plane through a guess across a normal, or None where Newton fails."""
    found = _on_chord(system, guess, np.asarray(normal, dtype=float), 0.0)
    return None if found is None else found.orbit


def rest_jacobian(
    system: PiecewiseLinearSystem, point: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(2, 3) derivatives of the velocities after half a period by (x0, y0, T/2)."""
    jacobian = np.empty((2, 3))
    work = np.empty((MAX_SEGMENTS, 9)), np.empty(MAX_SEGMENTS), np.empty(2)
    rest_conditions(system.rows, point, *work, jacobian, np.empty(4))
    return jacobian


def is_primitive(system: PiecewiseLinearSystem, orbit: Orbit) -> bool:
    """Whether an orbit is not a shorter one that is run through several times."""
    return bool(shorter_orbits.times_run_through(system.rows, orbit.point) == 1)


def orbit_on_branch(
    system: PiecewiseLinearSystem,
    start: NDArray[np.float64],
    direction: NDArray[np.float64],
    y_stop: float,
    settings: TraceSettings,
) -> tuple[Orbit | None, TraceEnd]:
    """The branch's orbit at y0 = y_stop, and why the trace ended; None where it is not met."""
    orbits, end = trace_branch(system, start, direction, y_stop, settings, 0.0)
    return (orbits[-1] if orbits else None), end


def trace_branch(
    system: PiecewiseLinearSystem,
    start: NDArray[np.float64],
    direction: NDArray[np.float64],
    y_stop: float,
    settings: TraceSettings,
    spacing: float,
) -> tuple[list[Orbit], TraceEnd]:
    """Orbits of a branch, of which the last alone has known switching times, and why it ended.

    Args:
        start, direction: (3,) a solution and the way to go; neither needs to be regular.
        y_stop: larger y of the instants of rest at which the trace ends.
    """
    motion = np.array([start, direction / np.linalg.norm(direction)], dtype=float)
    pace, control = np.array([settings.first_step, *[0.0] * 5]), settings.control()
    table = np.empty((_ROWS_PER_CALL if spacing else 1, len(branch_tracing.COLUMNS)))
    switches, orbits = np.empty(MAX_SEGMENTS), []
    end = branch_steps.GOES_ON
    while end == branch_steps.GOES_ON:
        count, end = branch_tracing.trace(
            system.rows, motion, pace, control, y_stop, spacing, table, switches
        )
        orbits += [_orbit(row, np.full(MAX_SEGMENTS, np.nan)) for row in table[:count]]
        if spacing:
            report(lambda: motion[0, 1] / y_stop)
    if orbits:
        orbits[-1] = replace(
            orbits[-1], switches=switches[: len(orbits[-1].switches)].copy()
        )
    return orbits, TraceEnd(end)


def _orbit(row: NDArray[np.float64], switches: NDArray[np.float64]) -> Orbit:
    return Orbit(
        row[:3].copy(), switches[: int(row[7])].copy(), float(row[5]), float(row[6])
    )


def special_points(
    system: PiecewiseLinearSystem, orbits: Sequence[Orbit]
) -> list[tuple[SpecialPoint, Orbit]]:
    """Period doublings (index −2), other crossings of index 2, and folds of the peak, located.

    Args:
        orbits: consecutive orbits of one branch; each change of sign between two is followed
            down to round-off by solving for orbits on the plane across their chord, and looked
            for in pairs where the curvature along the chord leaves room for them.
    """
    found = []
    for first, second in pairwise(orbits):
        chord = _same_rest(system, first, second) - first.point
        ends = [_on_chord(system, first.point, chord, share) for share in (0.0, 1.0)]
        if ends[0] is None or ends[1] is None:
            continue
        samples = _between(system, first.point, chord, ends[0], ends[1], _MOST_SPLITS)
        for left, right in pairwise([ends[0], *samples, ends[1]]):
            for kind in SpecialPoint:
                if left.clear_sign[kind] * right.clear_sign[kind] < 0.0:
                    located = _locate(system, first.point, chord, left, right, kind)
                    if located is not None:
                        found.append((kind, located.from_higher_rest(system)))
    return found


def _same_rest(
    system: PiecewiseLinearSystem, first: Orbit, second: Orbit
) -> NDArray[np.float64]:
    """The second orbit from the instant of rest that continues the first one's.

    Of the two instants of rest another may become the higher one between two orbits.
    """
    here, there = second.point[:2], second.other_rest(system)
    apart = [np.linalg.norm(rest - first.point[:2]) for rest in (here, there)]
    return np.array([*(here if apart[0] <= apart[1] else there), second.point[2]])


@dataclass(frozen=True)
class _OnChord:
    """The orbit on the plane across a chord at a share of its length."""

    share: float
    orbit: Orbit
    tangent: NDArray[np.float64]

    @property
    def measures(self) -> NDArray[np.float64]:
        """What changes its sign at each kind of special point."""
        index = self.orbit.stability_index
        return np.array([index + 2.0, index - 2.0, self.tangent[1]])

    @property
    def clear_sign(self) -> NDArray[np.float64]:
        """Signs of the measures; 0 within round-off, as of the direction where branches meet."""
        clear = abs(self.measures) > _CLEAR
        clear[SpecialPoint.fold] &= clear[SpecialPoint.index_two]
        return np.where(clear, np.sign(self.measures), 0.0)


def _on_chord(
    system: PiecewiseLinearSystem,
    start: NDArray[np.float64],
    chord: NDArray[np.float64],
    share: float,
) -> _OnChord | None:
    point, segments = start + share * chord, np.empty((MAX_SEGMENTS, 9))
    switches, final, tangent = np.empty(MAX_SEGMENTS), np.empty(4), np.empty(3)
    normal = chord / np.linalg.norm(chord)
    count, _, residual = solve_constrained(
        system.rows, point, normal, 0.0, segments, switches, final, tangent
    )
    if count == 0:
        return None
    index = float(stability_index(system.rows, segments, count))
    sign = 1.0 if float(tangent @ normal) > 0.0 else -1.0
    orbit = Orbit(point, switches[: count - 1].copy(), index, float(residual))
    return _OnChord(share, orbit, sign * tangent)


def _between(
    system: PiecewiseLinearSystem,
    start: NDArray[np.float64],
    chord: NDArray[np.float64],
    left: _OnChord,
    right: _OnChord,
    splits: int,
) -> list[_OnChord]:
    """Orbits between two, by halving wherever a measure may have two zeros between them."""
    middle = _on_chord(system, start, chord, 0.5 * (left.share + right.share))
    if middle is None or splits == 0:
        return []
    low, half, high = left.measures, middle.measures, right.measures
    nearest = np.minimum(np.sign(low) * half, np.minimum(abs(low), abs(high)))
    bend = abs(half - 0.5 * (low + high))
    one_side = left.clear_sign * right.clear_sign > 0.0
    if not (one_side & (nearest < _ROOM * bend)).any():
        return []
    return [
        *_between(system, start, chord, left, middle, splits - 1),
        middle,
        *_between(system, start, chord, middle, right, splits - 1),
    ]


def _locate(
    system: PiecewiseLinearSystem,
    start: NDArray[np.float64],
    chord: NDArray[np.float64],
    first: _OnChord,
    last: _OnChord,
    kind: SpecialPoint,
) -> Orbit | None:
    """The zero of a measure along the chord; None where an orbit in between is not found."""

    def at(share: float) -> _OnChord:
        found = _on_chord(system, start, chord, share)
        if found is None:
            raise ArithmeticError
        return found

    try:
        share = brentq(
            lambda share: at(share).measures[kind],
            first.share,
            last.share,
            xtol=1e-16,
            rtol=1e-15,
        )
        return at(share).orbit
    except ArithmeticError:
        return None


def decoupled_half_period(system: PiecewiseLinearSystem, y_peak: float) -> float:
    """T/2 of a y motion that does not feel x: one spring above the threshold, another below."""
    above, below = system.above, system.below
    frequency = math.sqrt(above.matrix[1][1])
    centre = above.load[1] / above.matrix[1][1]
    fall = math.acos((system.threshold - centre) / (y_peak - centre))
    speed = (y_peak - centre) * frequency * math.sin(fall)
    stiff = math.sqrt(below.matrix[1][1])
    offset = system.threshold - below.load[1] / below.matrix[1][1]
    return fall / frequency + (math.pi - math.atan2(speed / stiff, offset)) / stiff


def shape(
    system: PiecewiseLinearSystem, point: NDArray[np.float64]
) -> tuple[float, float, float]:
    """(x amplitude, y amplitude, largest |vx|) over a period; amplitudes are half peak-to-peak."""
    out = np.empty(6)
    extremes(system.rows, np.ascontiguousarray(point[:3], dtype=float), out)
    return (
        0.5 * (out[1] - out[0]),
        0.5 * (out[3] - out[2]),
        float(np.abs(out[4:]).max()),
    )


def index_from_switches(
    system: PiecewiseLinearSystem,
    switches: NDArray[np.float64],
    half_period: float,
    y0: float,
) -> float:
    """Stability index of a motion that switches at given times of its half period.

    The tangent flow depends on the motion through these times alone, so this serves a series
    as well as an exact orbit: it is the exact trace − 2 of the approximate orbit.
    """
    times = np.concatenate([[0.0], switches, [half_period]])
    segments = np.empty((len(times) - 1, 9))
    side = int(y0 > system.threshold)
    for leg, duration in enumerate(np.diff(times)):
        propagator(system.rows[side], float(duration), segments[leg])
        segments[leg, 8] = side
        side = 1 - side
    return float(stability_index(system.rows, segments, len(segments)))
