"""The kind of motion of a system from each of many starts."""

from __future__ import annotations

import math
from enum import IntEnum
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.methods.recurrence import LEAST_REPEATS, in_blocks, repeats_after
from squealpipe.schema import Outcome, flag_table
from squealpipe.schema.systems import build
from squealpipe.systems import runs
from squealpipe.validation import NotNegative, Tolerance, Values, Workers, checked

AT_REST = 1e-3
"""A motion rests whose states stay this close together, over their ranges in the whole run."""
REPEATED = 1e-6
"""Largest difference of intervals, over the period, or of states, over their ranges, in a cycle."""
MOST_PERIODS = 32
"""Periods of the forcing up to which a cycle is sought."""
SAME_ATTRACTOR = 1e-3
"""Extremes of one attractor from two starts differ by less, over those of all attractors."""


class Motion(IntEnum):
    """Kind of motion in the second half of a run."""

    unsettled = 0
    rest = 1
    cycle = 2


@checked
def basin(
    system: Any,
    t_end: NotNegative,
    *,
    start: Values,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
    **parameters: Any,
) -> xr.Dataset:
    """Runs from many starts, and the kind of motion in the second half of each.

    At *rest* every state stays within 1e-3 of its range in the whole run. On a *cycle* the motion
    repeats three times at least: with a forcing the states after so many of its periods, else the
    kinds of events and the intervals between them; of an autonomous motion without events both
    quarters have the same extremes. All else is *unsettled*.

    Args:
        start: states that differ from the system's start, numbers or 1-D arrays, and ``regime``.
        parameters: those that differ from the system's, numbers or 1-D arrays.

    Returns:
        Dataset over the arrays' dimensions, starts first: ``motion``; ``attractor``, which numbers
        rests and cycles by their extremes (-1: unsettled); ``period`` (NaN: none is known);
        ``<state>_min`` and ``<state>_max`` of the last quarter; ``outcome``.
    """
    grid = runs.outer_product(system, start, parameters)
    size = math.prod(grid.shape)

    def run(rows: Any, share: float = 1.0, late: float = 1.0, **options: Any) -> Any:
        values = {name: value[rows] for name, value in grid.values.items()}
        ends = np.full(values[system.states[0]].size, share * t_end)
        return runs.integrate(
            system,
            values,
            ends,
            t_late=late * t_end,
            tol=tol,
            regime=grid.regime,
            workers=workers,
            tracked=system.states,
            **options,
        )

    whole = run(slice(None), late=0.75)
    third = run(slice(None), 0.75, 0.5)
    spans = np.maximum(np.ptp(whole["extremes"], axis=-1), np.finfo(float).tiny)
    (low, high), (last_low, last_high) = (
        np.moveaxis(each["late_extremes"], -1, 0) for each in (third, whole)
    )
    stays = np.maximum(high, last_high) - np.minimum(low, last_low)
    rests = (stays <= AT_REST * spans).all(axis=1)
    with np.errstate(invalid="ignore"):  # infinite where a run ended before
        alike = np.maximum(np.abs(high - last_high), np.abs(low - last_low))
    period = np.full(size, np.nan)
    repeats = np.zeros(size, bool)
    counts = whole["counts"].sum(axis=1)
    moving = np.flatnonzero(~rests & (whole["ends"][:, 0] == Outcome.converged))
    if system.period is not None:
        names = SimpleNamespace(**grid.values)
        with np.errstate(divide="ignore"):
            forcing = np.broadcast_to(np.asarray(system.period(names), float), size)
        if not (np.isfinite(forcing) & (forcing > 0.0)).all():
            raise ValueError(
                f"{system.name}: the period of its forcing must be greater than 0"
            )
        kept = int(
            np.clip(0.5 * t_end / forcing.max(), 0, LEAST_REPEATS * MOST_PERIODS)
        )
        times = t_end - forcing[moving, None] * np.arange(kept, -1, -1)
        states = run(moving, times=times)["samples"] / spans[moving, None]
        rounds = np.zeros(moving.size, int)
        for lag in range(kept // LEAST_REPEATS, 0, -1):
            off = (
                np.abs(states[:, lag:] - states[:, :-lag]).max(axis=2, initial=0.0)
                <= REPEATED
            )
            # at first the distance to a cycle may be less after several of its periods
            again = off.all(axis=1) | ((rounds > 0) & (rounds % lag == 0) & off[:, -1])
            rounds[again] = lag
        period[moving] = np.where(rounds, rounds * forcing[moving], np.nan)
        repeats = np.isfinite(period)
    else:
        for rows in in_blocks(moving, counts):
            logged = run(rows, log_events=max(1, int(counts[rows].max())))
            for row, at, kinds in zip(
                rows, logged["event_times"], logged["event_kinds"], strict=True
            ):
                late = at > 0.5 * t_end
                lag = repeats_after(at[late], kinds[late], REPEATED)
                period[row] = at[late][lag] - at[late][0] if lag else np.nan
                silent = not late.any() and (alike[row] <= REPEATED * spans[row]).all()
                repeats[row] = lag > 0 or silent
    motion = np.select([rests, repeats], [Motion.rest, Motion.cycle], Motion.unsettled)
    ended = np.isfinite(whole["late_extremes"]).all(axis=(1, 2)) & (
        whole["ends"][:, 0] == Outcome.converged
    )
    motion[~ended] = Motion.unsettled
    over, shape = tuple(grid.coordinates), grid.shape
    numbers = _numbered(motion, whole["late_extremes"])
    found: dict[str, Any] = {
        "motion": runs.flag(
            "what the motion has become",
            over,
            motion.reshape(shape),
            flag_table(Motion),
        ),
        "attractor": (
            over,
            numbers.reshape(shape),
            runs.labels("number of the attractor", "1"),
        ),
        "period": (
            over,
            period.reshape(shape),
            runs.labels("period of the cycle", "s"),
        ),
        "outcome": runs.outcome(system, over, whole["ends"][:, 0].reshape(shape)),
    }
    for i, (name, unit) in enumerate(system.units.items()):
        for which, word, values in (
            ("min", "smallest", last_low),
            ("max", "largest", last_high),
        ):
            column = np.where(np.isfinite(values[:, i]), values[:, i], np.nan)
            label = runs.labels(f"{word} {name} in the last quarter", unit)
            found[f"{name}_{which}"] = (over, column.reshape(shape), label)
    attributes = runs.attributes(system, "basin", grid.fixed, tol)
    return build("basin", found, grid.coordinates, attributes)


def _numbered(motion: np.ndarray, extremes: np.ndarray) -> np.ndarray:
    """Equal numbers for rests, or cycles, whose extremes are equal, in the order of their runs."""
    numbers = np.full(motion.size, -1)
    settled = np.flatnonzero(motion != Motion.unsettled)
    number = 0
    spans = np.ptp(extremes[settled], axis=(0, 2)) if settled.size else np.empty(0)
    while settled.size:
        ends = extremes[settled]
        off = np.abs(ends - ends[0]) <= SAME_ATTRACTOR * spans[:, None]
        same = off.all(axis=(1, 2)) & (motion[settled] == motion[settled[0]])
        numbers[settled[same]] = number
        settled, number = settled[~same], number + 1
    return numbers
