"""Boundaries of quiet: for each change alone, the nearest value at which the verdict changes.

Idea: a cure is one parameter that is changed while the others keep their values. The search of
:mod:`squealpipe.vibration.cures` does the work: growth of small motions splits the range of a cure
without a run, runs of pushed steady sliding bisect for the boundary, and motions that last beside
steady sliding are followed to where the last of them ends. The two angles are searched together in
the same way, along rays. Invariant: a boundary is NaN where none was found in the range. Cost: that
of the runs.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from squealpipe.brake.assess.designs import CureRanges, cures_of
from squealpipe.brake.assess.settling import (
    MOST_PERIODS_OF_A_PAD,
    pushed,
    settle,
    start_at,
    strikes,
)
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.assess.snap_through import SnapThrough, snap_throughs
from squealpipe.brake.schema.assess import CURES
from squealpipe.codes import Verdict
from squealpipe.vibration.boundaries import (
    Cure,
    linear_intervals,
    nearest_boundary,
    quiet_intervals,
)
from squealpipe.vibration.cures import Boundary, boundaries, by_change, pushes_die_out
from squealpipe.vibration.settled_runs import SettledRun, Start


def growth_margin(design: Design) -> float:
    """Return by how much small motions grow faster than round-off, 1/s.

    A design that has no steady sliding gets a positive number.
    """
    sliding = Sliding.of(design)
    return design.rate if sliding is None else sliding.margin


@dataclass(frozen=True)
class Pads:
    """Answers for pads to :class:`squealpipe.vibration.any_start.Subjects`.

    Attributes:
        tol: tolerance of the runs.
    """

    tol: float

    def is_quiet_linearly(self, subject: Design) -> bool:
        """Tell whether steady sliding exists, and small motions about it do not grow."""
        return growth_margin(subject) <= 0.0

    def push(self, subject: Design) -> Start:
        """Return steady sliding, pushed in the direction in which small motions grow fastest."""
        sliding = Sliding.of(subject)
        assert sliding is not None  # noqa: S101 (it is quiet linearly)
        return pushed(subject, sliding)

    def fading(self, subject: Design) -> float:
        """Return ln of the factor by which small motions shrink within the longest run.

        It is NaN where they grow or there is no steady sliding.
        """
        sliding = Sliding.of(subject)
        if sliding is None or sliding.is_unstable:
            return math.nan
        return sliding.growth_rate * subject.period * MOST_PERIODS_OF_A_PAD

    def starts(
        self, subject: Design, number: int, motions: Sequence[np.ndarray]
    ) -> list[Start]:
        """Return the starts of one kind.

        Args:
            number: 0 for the states of ``motions``, 1 for rest at r = 0, 2 for strikes of steady
                sliding.
            motions: states (4,), m and m/s.
        """
        sliding = Sliding.of(subject)
        if number == 2:
            return [] if sliding is None else strikes(subject, sliding)
        states = motions if number == 0 else [np.zeros(4)]
        return [start_at(subject, sliding, state) for state in states]

    def settle(self, starts: Sequence[Start]) -> list[SettledRun]:
        """Run each start until it has settled, and return the runs in the order of the starts."""
        return settle(starts, tol=self.tol)


def pad_boundaries(
    design: Design, verdict: Verdict, motions: Sequence[np.ndarray], *, tol: float
) -> tuple[dict[str, Boundary], dict[str, SnapThrough]]:
    """Return the boundary of each cure of a design, and where a quiet pad snaps along it.

    The cure with the smallest change comes first; those without a boundary come last.

    Args:
        verdict: verdict on the design as it is.
        motions: states (4,) of its settled motions that are not quiet, m and m/s.
        tol: tolerance of the runs.
    """
    cures = cures_of(design)
    quiet = verdict is Verdict.quiet
    linear = {
        name: linear_intervals(cure, growth_margin) for name, cure in cures.items()
    }
    by_cure = boundaries(
        {name: cures[name] for name in CURES},
        linear,
        Pads(tol),
        motions,
        quiet=quiet,
        always=quiet and not motions and Sliding.of(design) is not None,
    )
    nearest = {name: boundary.quiet_from for name, boundary in by_cure.items()}
    return by_change(by_cure), snap_throughs(cures, nearest) if quiet else {}


def nearest_angles(
    design: Design, verdict: Verdict, *, tol: float
) -> tuple[float, float]:
    """Return the nearest pair of angles found at which the verdict changes, rad; NaN if none is.

    The boundary is located along rays from the present pair, as for a cure. Between two rays
    another pair may be nearer by a few per cent.
    """
    steps = CureRanges.angle_step * np.arange(
        1, 1 + round(CureRanges.farthest_angle / CureRanges.angle_step)
    )
    # directions in which the nearest quiet pair of angles is sought
    rays = [
        Cure(0.0, partial(_turned, design, turn), np.zeros(0), steps, is_angle=True)
        for turn in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    ]
    quiet = verdict is Verdict.quiet
    # no noisy pair turns quiet before small motions die out, so that a boundary up to the first
    # step at which they do along any ray is the nearest
    first = len(steps)
    if not quiet:
        stable = (
            number
            for number, step in enumerate(steps.tolist(), 1)
            if any(growth_margin(ray.apply(step)) <= 0.0 for ray in rays)
        )
        first = next(stable, first)
    for count in dict.fromkeys((first, len(steps))):
        cut = [ray._replace(above=steps[:count]) for ray in rays]
        distance, ray = _nearest_boundary(cut, quiet=quiet, tol=tol)
        if not math.isnan(distance):
            nearest = ray.apply(distance)
            return nearest.alpha1, nearest.alpha2
    return math.nan, math.nan


def _turned(design: Design, turn: float, distance: float) -> Design:
    """Return the design with angles at a distance in a direction, rad."""
    return design._replace(
        alpha1=design.alpha1 + distance * math.cos(turn),
        alpha2=design.alpha2 + distance * math.sin(turn),
    )


def _nearest_boundary(
    rays: Sequence[Cure], *, quiet: bool, tol: float
) -> tuple[float, Cure]:
    """Return the nearest boundary along rays from 0, NaN if there is none, and its ray."""
    named = {str(number): ray for number, ray in enumerate(rays)}
    linear = {
        name: linear_intervals(ray, growth_margin)[:1] for name, ray in named.items()
    }
    dies_out = partial(pushes_die_out, subjects=Pads(tol))
    intervals = quiet_intervals(named, linear, dies_out, quiet=quiet)
    known = {
        name: nearest_boundary(those, 0.0, quiet=quiet)
        for name, those in intervals.items()
    }
    best = min(known, key=lambda name: known[name] if known[name] > 0 else math.inf)
    return (known[best] if known[best] >= 0.0 else math.nan), named[best]
