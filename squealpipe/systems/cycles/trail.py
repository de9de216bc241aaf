"""The points of a branch so far, and how a branch may end by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from squealpipe.systems.branch_labels import Label
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.cycles.line import at_special_points
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.datasets import Outcome


@dataclass(frozen=True)
class TrailDistances:
    """Distances along a branch of cycles by which its end is told."""

    at_rest: float = 1e-3
    """Size of a cycle, over the largest on its branch, below which one that shrinks comes to
    rest."""
    met: float = 0.03
    """Distance from a cycle of a part of the period, over its extent, where a branch ends on it."""


@dataclass(frozen=True)
class BranchPoint:
    """A cycle on a branch; ``rest`` is where one that has all but shrunk to rest has no size."""

    state: ContinuationState
    cycle: Cycle
    label: Label = Label.regular
    rest: float | None = None

    @property
    def parameter(self) -> float:
        """Value of the followed parameter."""
        return float(self.cycle.followed[-1]) if self.rest is None else self.rest


def _sizes_of(shapes: list[Vector]) -> Vector:
    """The largest extent of each cycle."""
    lowest, highest = np.split(np.array(shapes)[:, 2:], 2, axis=1)
    return np.asarray((highest - lowest).max(axis=1))


class Trail:
    """The points of a branch so far."""

    def __init__(self) -> None:
        self.points: list[BranchPoint] = []
        self.shapes: list[Vector] = []

    def add(self, point: BranchPoint) -> None:
        """One more point."""
        self.points.append(point)
        self.shapes.append(self._shape(point.cycle, point.state))

    def _shape(self, cycle: Cycle, state: ContinuationState) -> Vector:
        """Return the part of a cycle that does not depend on the phase: parameter, period,
        extremes; without units.
        """
        first = self.points[0].cycle.map if self.points else cycle.map
        extremes = cycle.extremes[:, : len(first.scale)] / first.scale
        return np.array([state.point[-1], cycle.period / first.time, *extremes.ravel()])

    def meets(self) -> Outcome | None:
        """Return whether the last step lies on an older piece of the branch."""
        shapes = np.array(self.shapes)
        if len(shapes) < 6:
            return None
        ahead, pieces = shapes[-1] - shapes[-2], np.diff(shapes[:-3], axis=0)
        squared = np.maximum((pieces**2).sum(axis=1), 1e-300)
        offset = shapes[-1] - shapes[:-4]
        share = np.clip((offset * pieces).sum(axis=1) / squared, 0.0, 1.0)
        distance = np.linalg.norm(offset - share[:, None] * pieces, axis=1)
        length = max(float(np.linalg.norm(ahead)), 1e-300)
        cosine = (pieces @ ahead) / np.sqrt(squared) / length
        # a point this close to an older piece of the branch, over that piece, is on it: the
        # branch is closed
        near = distance < 1e-3 * np.minimum(np.sqrt(squared), length)
        if (near & (cosine > 0.99)).any():
            return Outcome.closed
        return Outcome.retraced if (near & (cosine < -0.99)).any() else None

    def is_met(self, point: BranchPoint) -> bool:
        """Return whether a fold is where the branch ends on a cycle of a part of the period."""
        near = (
            min(float(np.linalg.norm(point.cycle.after_part(n))) for n in (2, 3))
            < TrailDistances.met
        )
        return near and point.label == Label.fold

    def reason(self) -> Outcome:
        """Reason why no step leads on."""
        cycle = self.points[-1].cycle
        if self.has_shrunk(cycle):
            return Outcome.equilibrium
        if self.is_unbounded:
            return Outcome.period_unbounded
        second = float(np.abs(cycle.nontrivial - 1.0).min(initial=1.0))
        parts = [float(np.linalg.norm(cycle.after_part(n))) for n in (2, 3)]
        return (
            Outcome.tongue_end
            if min(parts) < TrailDistances.met and second < TrailDistances.met
            else Outcome.branch_lost
        )

    @property
    def stands_still(self) -> bool:
        """Tell whether none of the last ten steps moved the parameter by 1e-9 of it.

        Closer to a homoclinic orbit round-off decides how a branch goes on, and whether it ends.
        """
        values = np.array(self.shapes[-11:])[:, 0]
        moved = np.abs(np.diff(values))
        return moved.size == 10 and bool((moved <= 1e-9 * abs(values[-1])).all())

    @property
    def is_unbounded(self) -> bool:
        """Tell whether the period has grown by half while the parameter all but stood still.

        Next to a homoclinic orbit the period grows as the logarithm of the distance.
        """
        values, periods = np.array(self.shapes)[:, :2].T
        # a period that grows by half while the parameter stands still is unbounded: a homoclinic
        # orbit
        near = np.abs(values - values[-1]) <= 1e-3 * abs(values[-1])
        first = 0 if near.all() else len(near) - int(np.argmin(near[::-1]))
        # the last points are so close that round-off makes their periods fall a little
        rises = bool((np.diff(periods[first:]) > -1e-6 * periods[-1]).all())
        return rises and bool(periods[-1] >= 1.5 * periods[first])

    def has_shrunk(self, cycle: Cycle, share: float = TrailDistances.at_rest) -> bool:
        """Return whether a cycle without forcing is next to a state of rest."""
        if cycle.map.periods:
            return False
        sizes = _sizes_of([*self.shapes, self._shape(cycle, self.points[-1].state)])
        return bool(sizes[-1] < share * sizes[:-1].max())

    def rest(self) -> float | None:
        """Return the parameter at which a shrinking cycle is at rest: it is smooth in the square of
        the size.

        Of the smallest cycles round-off decides the parameter.
        """
        sizes, last = _sizes_of(self.shapes), self.points[-1].parameter
        fit = np.flatnonzero(sizes > 0.2 * TrailDistances.at_rest * sizes.max())[-3:]
        shapes = []
        for state, equations in (
            (self.points[i].state, self.points[i].cycle.map) for i in fit
        ):
            correction = at_special_points.solve(
                equations, state.point, state.tangent, 0.0
            )
            if correction is not None:
                shapes.append(
                    self._shape(Cycle.at(equations, correction.point), correction)
                )
        if len(shapes) < 3:
            return None
        squares = (_sizes_of(shapes) / sizes.max()) ** 2
        unit = float(self.points[-1].cycle.map.units[-1])
        beyond = np.array([shape[0] for shape in shapes]) * unit - last
        rest = float(scipy.interpolate.barycentric_interpolate(squares, beyond, 0.0))
        return (
            last + rest
            if abs(rest) < TrailDistances.at_rest * np.abs(beyond).max()
            else None
        )
