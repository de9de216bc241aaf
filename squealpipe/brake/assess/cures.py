"""Where a brake turns quiet, or, of a quiet one, where it no longer is: one change at a time."""

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from squealpipe.brake.assess.any_start import any_start, dies_out_always, lead
from squealpipe.brake.assess.designs import FARTHEST, STEP, Cure, cures_of
from squealpipe.brake.assess.search import LOCATED, Side, nearer, search, sides_of
from squealpipe.brake.assess.settling import pushed, settle
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.assess.snap_through import SnapThrough, snap_throughs
from squealpipe.brake.schema.assess import CURES
from squealpipe.codes import Verdict

RAYS = 24
"""Directions in which the nearest quiet pair of angles is looked for."""


class Boundary(NamedTuple):
    """What is known of one cure; values that were not found are NaN."""

    value: float
    quiet_from: float
    quiet_from_any_start: float
    change: float
    change_any_start: float
    lowest: float
    highest: float
    snaps_from: float
    snap_distance: float


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

    dies_out, test = partial(_dies_out, tol=tol), partial(dies_out_always, tol=tol)
    nearest = nearer(cures, search(sides_of(cures), quiet, dies_out, LOCATED))
    sides = sides_of(cures)
    for side in sides:
        side.motions = list(motions)
    always = quiet and not motions and Sliding.of(design) is not None
    if not quiet:
        lead(sides, nearest, tol=tol)
    follow = partial(dies_out_always, tol=tol, kinds=1)
    anywhere = any_start(cures, sides, nearest, quiet, always, test, follow)
    snaps = snap_throughs(cures, nearest) if quiet else {}
    located = {}
    for name, cure in cures.items():
        ends = [*cure.below, cure.value, *cure.above]
        first, second = nearest.get(name, math.nan), anywhere.get(name, math.nan)
        located[name] = Boundary(
            cure.value,
            first,
            second,
            _change(name, cure.value, first),
            _change(name, cure.value, second),
            min(ends),
            max(ends),
            *snaps.get(name, SnapThrough()),
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
    steps = STEP * np.arange(1, 1 + round(FARTHEST / STEP))
    sides = []
    for turn in np.linspace(0.0, 2.0 * math.pi, RAYS, endpoint=False):
        along, across = math.cos(turn), math.sin(turn)

        def apply(
            distance: float, along: float = along, across: float = across
        ) -> Design:
            return design._replace(
                alpha1=design.alpha1 + distance * along,
                alpha2=design.alpha2 + distance * across,
            )

        cure = Cure(0.0, apply, np.zeros(0), steps)
        sides.append(Side("alpha", cure, steps, 0.0))

    dies_out = partial(_dies_out, tol=tol)
    found = search(sides, verdict is Verdict.quiet, dies_out, LOCATED)
    known = [side for side in found if not math.isnan(side.answer)]
    if not known:
        return math.nan, math.nan
    best = min(known, key=lambda side: side.answer)
    there = best.cure.apply(best.answer)
    return there.alpha1, there.alpha2


def _change(name: str, value: float, found: float) -> float:
    """Per cent of the present value, or degrees; points of critical damping from none."""
    if name.startswith("alpha"):
        return math.degrees(found - value)
    return 100.0 * (found - value) / (value or 1.0)


def _dies_out(
    sides: Sequence[Side], values: Sequence[float], *, tol: float
) -> list[bool]:
    """Whether pushed steady sliding of each side's design ends quiet; where there is none, no."""
    rows, starts = [], []
    for row, (side, value) in enumerate(zip(sides, values, strict=True)):
        design = side.cure.apply(value)
        sliding = Sliding.of(design)
        if sliding is not None and not sliding.is_unstable:
            rows.append(row)
            starts.append(pushed(design, sliding))
    answers = [False] * len(sides)
    for row, settled in zip(rows, settle(starts, tol=tol) if rows else [], strict=True):
        answers[row] = settled.verdict is Verdict.quiet
    return answers
