"""Find what stops a vibration: for each parameter alone, all quiet values and the nearest of them.

Idea: the stretches in which small motions die out are known without a run (``linear``). Runs of a
push tell in which of them, and how far, the subject is quiet; then the motions that last beside
steady sliding are followed to where the last of them ends.

Invariant: pads and structures differ in their subjects alone. Cost: that of the runs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from squealpipe.vibration.any_start import Subjects, any_start, sides_of
from squealpipe.vibration.boundaries import (
    Cure,
    QuietInterval,
    interval_table,
    nearest_boundary,
    quiet_intervals,
)


class Boundary(NamedTuple):
    """Boundary that one cure reaches; values that were not found are NaN.

    Attributes:
        intervals: all quiet ones, the nearest first.
        is_run: whether other starts than pushes were run.
    """

    cure: Cure
    quiet_from: float
    quiet_from_any_start: float
    intervals: Sequence[QuietInterval]
    is_run: bool = True

    @property
    def change(self) -> float:
        """Change of the present value to the nearest quiet one."""
        return self.cure.change(self.quiet_from)

    @property
    def change_any_start(self) -> float:
        """Change of the present value to the nearest that is quiet from any start."""
        return self.cure.change(self.quiet_from_any_start)


def boundaries(
    cures: Mapping[str, Cure],
    linear: Mapping[str, Sequence[QuietInterval]],
    subjects: Subjects,
    motions: Sequence[np.ndarray],
    *,
    quiet: bool,
    always: bool,
) -> dict[str, Boundary]:
    """Return what each cure reaches, in the order of the cures.

    Args:
        linear: stretches of each in which small motions do not grow.
        motions: states of motions of the present subject that are not quiet.
        quiet: whether a push dies out now.
        always: whether any start does.
    """
    by_cure = of_pushes(cures, linear, subjects, quiet=quiet)
    return of_any_start(by_cure, subjects, motions, quiet=quiet, always=always)


def of_pushes(
    cures: Mapping[str, Cure],
    linear: Mapping[str, Sequence[QuietInterval]],
    subjects: Subjects,
    *,
    quiet: bool,
) -> dict[str, Boundary]:
    """Return what each cure reaches after a push alone, see :func:`boundaries`."""
    dies_out = partial(pushes_die_out, subjects=subjects)
    intervals = quiet_intervals(cures, linear, dies_out, quiet=quiet)
    return {
        name: Boundary(
            cure,
            nearest_boundary(intervals[name], cure.value, quiet=quiet),
            math.nan,
            intervals[name],
            is_run=False,
        )
        for name, cure in cures.items()
    }


def of_any_start(
    by_cure: Mapping[str, Boundary],
    subjects: Subjects,
    motions: Sequence[np.ndarray],
    *,
    quiet: bool,
    always: bool,
    closely: bool = True,
) -> dict[str, Boundary]:
    """Return what cures reach from any start, where it is known what they do after a push.

    Args:
        closely: whether motions are followed in small steps to where they end. Otherwise they are
            put at the values tried, and the nearest at which all starts die out is the answer.
    """
    cures = {name: boundary.cure for name, boundary in by_cure.items()}
    nearest = {name: boundary.quiet_from for name, boundary in by_cure.items()}
    sides = sides_of(cures)
    for side in sides:
        side.motions = list(motions)
    anywhere = any_start(
        cures, sides, nearest, subjects, quiet=quiet, always=always, closely=closely
    )
    return {
        name: boundary._replace(
            quiet_from_any_start=anywhere.get(name, math.nan), is_run=True
        )
        for name, boundary in by_cure.items()
    }


def by_change(by_cure: Mapping[str, Boundary]) -> dict[str, Boundary]:
    """Return the boundaries by ascending change; those that were not found come last."""

    def size(name: str) -> float:
        change = abs(by_cure[name].change)
        return math.inf if math.isnan(change) else change

    return {name: by_cure[name] for name in sorted(by_cure, key=size)}


def cure_table(
    by_cure: Mapping[str, Boundary], units: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """Return the variables of the dataset over ``cure``."""
    rows = list(by_cure.values())
    columns = {
        name: [getattr(row, name) for row in rows]
        for name in ("quiet_from", "quiet_from_any_start", "change", "change_any_start")
    }
    columns["value"] = [row.cure.value for row in rows]
    columns["lowest_tried"] = [row.cure.grid.min() for row in rows]
    columns["highest_tried"] = [row.cure.grid.max() for row in rows]
    return {
        **{name: np.array(values, float) for name, values in columns.items()},
        "cure_is_run": np.array([row.is_run for row in rows], bool),
        **interval_table([row.intervals for row in rows]),
        "unit": np.array([units[name] for name in by_cure], str),
    }


def pushes_die_out(
    cures: Sequence[Cure], values: Sequence[float], *, subjects: Subjects
) -> list[bool]:
    """Tell whether pushed steady sliding ends quiet; False if there is no steady sliding."""
    rows, starts = [], []
    answers = [False] * len(cures)
    for row, (cure, value) in enumerate(zip(cures, values, strict=True)):
        subject = cure.apply(value)
        if not subjects.is_quiet_linearly(subject):
            continue
        start = subjects.push(subject)
        if start is None:
            answers[row] = True
        else:
            rows.append(row)
            starts.append(start)
    runs = subjects.settle(starts) if starts else []
    for row, run in zip(rows, runs, strict=True):
        answers[row] = run.quiet
    return answers
