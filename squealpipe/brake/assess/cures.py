"""Boundaries of quiet: for each change alone, the nearest value at which the verdict changes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from squealpipe.brake.assess.designs import CURE_RANGES, cures_of
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
from squealpipe.vibration.any_start import any_start, dies_out_always, lead, sides_of
from squealpipe.vibration.boundaries import (
    Cure,
    QuietInterval,
    linear_intervals,
    nearest_boundary,
    quiet_intervals,
)
from squealpipe.vibration.settled_runs import SettledRun, Start


class Boundary(NamedTuple):
    """Boundary that one cure reaches; values that were not found are NaN."""

    value: float
    quiet_from: float
    quiet_from_any_start: float
    change: float
    change_any_start: float
    lowest: float
    highest: float
    snaps_from: float
    snap_distance: float
    intervals: Sequence[QuietInterval]


def growth_margin(design: Design) -> float:
    """Growth of small motions beyond round-off, 1/s; positive without any sliding."""
    sliding = Sliding.of(design)
    return design.rate if sliding is None else sliding.margin


@dataclass(frozen=True)
class Pads:
    """Pads as the search for other motions sees them.

    Attributes:
        tol: tolerance of the runs.
    """

    tol: float

    def is_quiet_linearly(self, subject: Design) -> bool:
        """Tell whether steady sliding exists, and small motions about it do not grow."""
        return growth_margin(subject) <= 0.0

    def fading(self, subject: Design) -> float:
        """Return ln of the decay of small motions within the longest run; NaN where they grow."""
        sliding = Sliding.of(subject)
        if sliding is None or sliding.is_unstable:
            return math.nan
        return sliding.growth_rate * subject.period * MOST_PERIODS_OF_A_PAD

    def starts(
        self, subject: Design, number: int, motions: Sequence[np.ndarray]
    ) -> list[Start]:
        """Return one kind of starts: states of motions, rest under the preload, or strikes."""
        sliding = Sliding.of(subject)
        if number == 2:
            return [] if sliding is None else strikes(subject, sliding)
        states = motions if number == 0 else [np.zeros(4)]
        return [start_at(subject, sliding, state) for state in states]

    def settle(self, starts: Sequence[Start]) -> list[SettledRun]:
        """Run starts until they have settled."""
        return settle(starts, tol=self.tol)


def boundaries(
    design: Design, verdict: Verdict, motions: Sequence[np.ndarray], *, tol: float
) -> dict[str, Boundary]:
    """All cures of a design.

    Args:
        verdict: of its steady sliding, pushed.
        motions: states of its settled motions that are not quiet.
    """
    cures = cures_of(design)
    quiet = verdict is Verdict.quiet

    pads = Pads(tol)
    linear = {
        name: linear_intervals(cure, growth_margin) for name, cure in cures.items()
    }
    dies_out = partial(_dies_out, tol=tol)
    intervals = quiet_intervals(cures, linear, dies_out, quiet=quiet)
    nearest = {
        name: nearest_boundary(intervals[name], cure.value, quiet=quiet)
        for name, cure in cures.items()
    }
    test = partial(dies_out_always, subjects=pads)
    sides = sides_of(cures)
    for side in sides:
        side.motions = list(motions)
    always = quiet and not motions and Sliding.of(design) is not None
    if not quiet:
        lead(sides, nearest, pads)
    follow = partial(dies_out_always, subjects=pads, kinds=1)
    anywhere = any_start(cures, sides, nearest, quiet, always, pads, test, follow)
    snaps = snap_throughs(cures, nearest) if quiet else {}
    located = {}
    for name, cure in cures.items():
        ends = [*cure.below, cure.value, *cure.above]
        first, second = nearest[name], anywhere.get(name, math.nan)
        located[name] = Boundary(
            cure.value,
            first,
            second,
            _change(name, cure.value, first),
            _change(name, cure.value, second),
            min(ends),
            max(ends),
            *snaps.get(name, SnapThrough()),
            intervals[name],
        )
    return dict(
        sorted(
            located.items(),
            key=lambda item: (
                math.inf if math.isnan(item[1].change) else abs(item[1].change),
                list(CURES).index(item[0]),
            ),
        )
    )


def nearest_angles(
    design: Design, verdict: Verdict, *, tol: float
) -> tuple[float, float]:
    """The nearest pair of angles at which the verdict changes, along rays; NaN: none.

    Along each ray it is located as a cure is; the nearest lies between two rays, a few per cent
    nearer.
    """
    steps = CURE_RANGES.angle_step * np.arange(
        1, 1 + round(CURE_RANGES.farthest_angle / CURE_RANGES.angle_step)
    )
    rays = {}
    # directions in which the nearest quiet pair of angles is sought
    for turn in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False):
        along, across = math.cos(turn), math.sin(turn)

        def apply(
            distance: float, along: float = along, across: float = across
        ) -> Design:
            return design._replace(
                alpha1=design.alpha1 + distance * along,
                alpha2=design.alpha2 + distance * across,
            )

        rays[f"{turn}"] = Cure(0.0, apply, np.zeros(0), steps, is_angle=True)
    quiet = verdict is Verdict.quiet
    linear = {
        name: linear_intervals(ray, growth_margin)[:1] for name, ray in rays.items()
    }
    intervals = quiet_intervals(rays, linear, partial(_dies_out, tol=tol), quiet=quiet)
    known = {
        name: nearest_boundary(those, 0.0, quiet=quiet)
        for name, those in intervals.items()
    }
    best = min(known, key=lambda name: known[name] if known[name] > 0 else math.inf)
    if not known[best] >= 0.0:
        return math.nan, math.nan
    there = rays[best].apply(known[best])
    return there.alpha1, there.alpha2


def _change(name: str, value: float, found: float) -> float:
    """Per cent of the present value, or degrees; points of critical damping from none."""
    if name.startswith("alpha"):
        return math.degrees(found - value)
    return 100.0 * (found - value) / (value or 1.0)


def _dies_out(
    cures: Sequence[Cure], values: Sequence[float], *, tol: float
) -> list[bool]:
    """Tell whether pushed steady sliding ends quiet; where there is none it does not."""
    rows, starts = [], []
    for row, (cure, value) in enumerate(zip(cures, values, strict=True)):
        design = cure.apply(value)
        sliding = Sliding.of(design)
        if sliding is not None and not sliding.is_unstable:
            rows.append(row)
            starts.append(pushed(design, sliding))
    answers = [False] * len(cures)
    for row, settled in zip(rows, settle(starts, tol=tol) if rows else [], strict=True):
        answers[row] = settled.quiet
    return answers
