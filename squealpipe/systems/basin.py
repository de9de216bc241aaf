"""The kind of motion of a system from each of many starts."""

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.systems.datasets import flag_table
from squealpipe.systems.grid import duration_of, outer_product
from squealpipe.systems.inputs.gate import (
    Natural,
    Number,
    Tolerance,
    Values,
    Workers,
    checked,
)
from squealpipe.systems.integrate import MOST_STEPS
from squealpipe.systems.labels import build, flag, outcome
from squealpipe.systems.motion import MotionKind, RepeatableRuns, drift_tolerance


@checked
def basin(
    system: Any,
    t_end: Number,
    *,
    t_start: Number = 0.0,
    start: Values,
    tol: Tolerance = 1e-12,
    max_steps: Natural = MOST_STEPS,
    workers: Workers = None,
    **parameters: Any,
) -> xr.Dataset:
    """Runs from many starts, and the kind of motion in the second half of each.

    At *rest* every state stays within 1e-3 of its range in the whole run. On a *cycle* the motion
    repeats three times at least: with a forcing the states after so many of its periods, else the
    kinds of events, the intervals between them and the states after them; an autonomous motion
    without events comes back to its state. Nor does it drift: over the last quarter of the run no
    state changes, at the same phase, by more than ``drift_tolerance`` of its range (1e3 ``tol``, at
    most 1e-6; an attribute of the dataset), or by so much less than over the quarter before that
    less than 1e-6 is still to come. All else is *unsettled*: a torus, chaos, slow decay or growth.
    Starts whose rests still move, and are as near to one another as they move, have one attractor.

    Args:
        t_end: when they end.
        t_start: when they begin: of a forced system another basin for each phase of its forcing.
        start: states that differ from the system's start, numbers or 1-D arrays, and ``regime``.
        max_steps: steps of a run, after which its outcome is ``step_limit``.
        parameters: those that differ from the system's, numbers or 1-D arrays.

    Returns:
        Dataset over the arrays' dimensions, starts first: ``motion``; ``attractor``, which numbers
        rests and cycles by their extremes (-1: unsettled); ``period`` (NaN: none is known);
        ``<state>_min`` and ``<state>_max`` of the last quarter; ``outcome``.
    """
    grid = outer_product(system, start, parameters)
    ensemble = RepeatableRuns(
        system,
        grid.values,
        duration_of(t_start, t_end),
        t_start,
        tol,
        grid.regime,
        workers,
        max_steps,
    )
    whole = ensemble.run(slice(None), late=0.75)
    motion, period = ensemble.judged(whole)
    late = whole["late_extremes"]
    return build(
        system,
        "basin",
        {
            "motion": flag(motion, flag_table(MotionKind)),
            "attractor": _numbered(motion, late),
            "period": period,
            "outcome": outcome(system, whole["outcome"]),
            **{
                f"<state>_{end}": dict(
                    zip(
                        system.states,
                        np.where(np.isfinite(each), each, np.nan).T,
                        strict=True,
                    )
                )
                for end, each in zip(
                    ("min", "max"), np.moveaxis(late, -1, 0), strict=True
                )
            },
        },
        grid.coordinates,
        grid.fixed,
        tol,
        drift_tolerance=drift_tolerance(tol),
    )


def renumbered(system: Any, dataset: xr.Dataset) -> xr.Dataset:
    """A system's basin put together from parts, its attractors numbered over all starts."""
    extremes = np.array(
        [
            [dataset[f"{name}_{which}"].values.ravel() for which in ("min", "max")]
            for name in system.units
        ]
    )
    motion = dataset.motion
    numbers = _numbered(motion.values.ravel(), np.moveaxis(extremes, -1, 0))
    attractor = dataset.attractor.copy(data=numbers.reshape(motion.shape))
    return dataset.assign(attractor=attractor)


def _numbered(motion: np.ndarray, extremes: np.ndarray) -> np.ndarray:
    """Equal numbers for rests, or cycles, whose extremes are equal, in the order of their runs.

    A rest that still decays is equal to another one as near as both move in the last quarter.
    """
    numbers = np.full(motion.size, -1)
    # twice: what is still to come is less than what was seen to go
    rests = motion == MotionKind.rest
    moves = np.where(rests[:, None], 2.0 * np.ptp(extremes, axis=2), 0.0)
    settled = np.flatnonzero(motion != MotionKind.unsettled)
    number = 0
    spans = np.ptp(extremes[settled], axis=(0, 2)) if settled.size else np.empty(0)
    while settled.size:
        ends = extremes[settled]
        # extremes of one attractor from two starts differ by less, over those of all attractors
        off = np.abs(ends - ends[0]).max(axis=2)
        round_off = 1e-12 * np.abs(ends).max(axis=(0, 2))
        near = off <= 1e-3 * spans + round_off + moves[settled] + moves[settled[0]]
        same = near.all(axis=1) & (motion[settled] == motion[settled[0]])
        numbers[settled[same]] = number
        settled, number = settled[~same], number + 1
    return numbers
