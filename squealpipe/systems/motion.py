"""Classification of the motions of many runs: rest, a cycle, or neither.

A cycle is shown by returns of the whole state: the extremes of a torus repeat too, and the events
of one part of a system do not know of the beat of another.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.systems.datasets import Outcome
from squealpipe.systems.integrate import MOST_STEPS, RunOptions, integrate
from squealpipe.systems.recurrence import (
    Recurrence,
    crossings,
    in_blocks,
    repeats_after,
)

AT_REST = 1e-3
"""A motion rests whose states stay this close together, over their ranges in the whole run."""


@dataclass(frozen=True)
class CycleRecognition:
    """Limits by which the late part of many runs is recognised as a cycle."""

    most_periods: int = 32
    """Periods of the forcing up to which a cycle is sought."""
    samples: int = 4096
    """Instants at which a return without events is looked for."""
    samples_per_step: int = 8
    """Samples in each step of the integrator."""
    near: float = 0.05
    """Distance of a sampled return, over the ranges, from which the exact one is looked for."""
    tries: int = 4
    """Returns that are looked at."""
    runs_at_once: int = 256
    """Runs whose samples are held in memory at once."""


limits = CycleRecognition()


def drift_tolerance(tol: float) -> float:
    """Return the drift in a quarter of a run, over the ranges, that errors of its steps may cause.

    A thousand steps are counted, each of which adds ``tol`` at most.
    """
    return min(1e3 * tol, Recurrence.repeated)


def has_settled(earlier: Any, later: Any, tolerance: float) -> Any:
    """Tell which motions that nearly repeat are cycles, by their drift in the last two quarters.

    A cycle that attracts is approached by ever smaller steps: what is still to come, the rest of
    the geometric series, is within 1e-6 of its range. Slow decay and growth go on at their pace.
    Drift below the tolerance counts as none.

    Args:
        earlier, later: largest change of a state over the third and the fourth quarter of the
            run, over the ranges, (runs,).
    """
    shrinks = later < earlier
    to_come = later**2 / np.where(shrinks, earlier - later, 1.0)
    return (later <= tolerance) | (shrinks & (to_come <= Recurrence.repeated))


class MotionKind(IntEnum):
    """Kind of motion in the second half of a run."""

    unsettled = 0
    rest = 1
    cycle = 2


@dataclass(frozen=True)
class RepeatableRuns:
    """Runs of a system from many starts, each for the same time, that can be made again.

    Attributes:
        values: states and parameters, (runs,).
        duration: of each run; times here count from its begin.
        t_start: what the system's functions take for the time there.
        regime: in which all start; by default what fits each.
        max_steps: of each run.
    """

    system: Any
    values: Mapping[str, np.ndarray]
    duration: float
    t_start: float
    tol: float
    regime: str | None
    workers: int | None
    max_steps: int = MOST_STEPS

    def run(
        self, rows: Any, share: float = 1.0, late: float = 1.0, **options: Any
    ) -> Any:
        """Some of the runs, up to a share of their duration."""
        values = {name: value[rows] for name, value in self.values.items()}
        values |= options.pop("states", {})
        count = values[self.system.states[0]].size
        chosen = {
            "regime": self.regime,
            "t_late": late * self.duration,
            "t_start": self.t_start,
            "most_steps": self.max_steps,
        } | options
        return integrate(
            self.system,
            values,
            np.full(count, share * self.duration),
            RunOptions(tracked=self.system.states, **chosen),
            tol=self.tol,
            workers=self.workers,
        )

    def judged(self, whole: Any) -> tuple[np.ndarray, np.ndarray]:
        """(:class:`MotionKind`, period; NaN: none is known) of each run.

        Args:
            whole: all runs, their late part the last quarter.
        """
        third = self.run(slice(None), 0.75, 0.5)
        spans = np.maximum(np.ptp(whole["extremes"], axis=-1), np.finfo(float).tiny)
        (low, high), (last_low, last_high) = (
            np.moveaxis(each["late_extremes"], -1, 0) for each in (third, whole)
        )
        stays = np.maximum(high, last_high) - np.minimum(low, last_low)
        rests = (stays <= AT_REST * spans).all(axis=1)
        ran = whole["outcome"] == Outcome.converged
        ended = np.isfinite(whole["late_extremes"]).all(axis=(1, 2)) & ran
        moving = np.flatnonzero(~rests & ran)
        period = np.full(len(rests), np.nan)
        if self.system.period is not None:
            period[moving] = self._after_forcing_periods(moving, spans)
        else:
            counts = whole["counts"].sum(axis=1)
            silent = np.zeros(len(rests), bool)
            for rows in in_blocks(moving, counts):
                period[rows], silent[rows] = self._between_events(
                    rows, int(counts[rows].max()), spans
                )
            steps = whole["steps"]
            quiet = np.flatnonzero(silent)
            for first in range(0, quiet.size, limits.runs_at_once):
                rows = quiet[first : first + limits.runs_at_once]
                period[rows] = self._without_events(
                    rows, spans[rows], np.maximum(steps[rows], 1)
                )
        repeats = np.isfinite(period)
        motion = np.select(
            [rests, repeats], [MotionKind.rest, MotionKind.cycle], MotionKind.unsettled
        )
        motion[~ended] = MotionKind.unsettled
        return motion, period

    def _after_forcing_periods(self, rows: np.ndarray, spans: np.ndarray) -> np.ndarray:
        """Periods after which all states at the same instants of the forcing repeat."""
        size = len(spans)
        with np.errstate(divide="ignore"):
            period = self.system.period(SimpleNamespace(**self.values))
        forcing = np.broadcast_to(np.asarray(period, float), size)
        if not (np.isfinite(forcing) & (forcing > 0.0)).all():
            raise ValueError(
                f"{self.system.name}: the period of its forcing must be greater than 0"
            )
        most = Recurrence.least_repeats * limits.most_periods
        kept = int(np.clip(0.5 * self.duration / forcing.max(), 0, most))
        quarter = (0.25 * self.duration / forcing[rows]).astype(int)[:, None]
        # also a quarter and half of the run earlier, for every number of periods that may repeat
        counts = (
            np.arange(limits.most_periods + 1),
            np.arange(2 * limits.most_periods + 1),
        )
        back = np.hstack(
            [
                np.tile(np.arange(kept, -1, -1), (rows.size, 1)),
                quarter - counts[0],
                2 * quarter - counts[1],
            ]
        ).clip(0)
        times = self.duration - forcing[rows, None] * back
        order = np.argsort(times, axis=1, kind="stable")
        samples = self.run(rows, times=np.take_along_axis(times, order, 1))["samples"]
        every = np.empty_like(samples)
        np.put_along_axis(every, order[:, :, None], samples, axis=1)
        every /= spans[rows, None]
        states = every[:, : kept + 1]
        rounds = np.zeros(rows.size, int)
        for lag in range(kept // Recurrence.least_repeats, 0, -1):
            moved = np.abs(states[:, lag:] - states[:, :-lag])
            near = moved.max(axis=2, initial=0.0) <= Recurrence.repeated
            # at first the distance to a cycle may be less after several of its periods
            again = near.all(axis=1) | (
                (rounds > 0) & (rounds % lag == 0) & near[:, -1]
            )
            rounds[again] = lag
        # a whole number of cycles fits into about a quarter of the run
        off = quarter[:, 0] % np.maximum(rounds, 1)
        row = np.arange(rows.size)
        middle, begin = (
            every[row, kept + 1 + off],
            every[row, kept + 1 + limits.most_periods + 1 + 2 * off],
        )
        earlier = np.abs(middle - begin).max(axis=1, initial=0.0)
        later = np.abs(every[:, kept] - middle).max(axis=1, initial=0.0)
        settled = has_settled(earlier, later, drift_tolerance(self.tol))
        return np.where((rounds > 0) & settled, rounds * forcing[rows], np.nan)

    def _between_events(
        self, rows: np.ndarray, most: int, spans: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(Period after which events and states repeat, whether there are no events at all)."""
        logged = self.run(rows, log_events=max(1, most))
        period, silent = np.full(rows.size, np.nan), np.zeros(rows.size, bool)
        for i, (row, times, kinds, states) in enumerate(
            zip(
                rows,
                *(logged[f"event_{name}"] for name in ("times", "kinds", "states")),
                strict=True,
            )
        ):
            late = times > 0.5 * self.duration
            silent[i] = not late.any()
            marks = states[late] / spans[row]
            lag = repeats_after(times[late], kinds[late], Recurrence.repeated, marks)
            if lag:
                # whole cycles in half of these events
                count = (len(marks) - 1) // (2 * lag) * lag
                begin, middle, end = marks[[0, count, 2 * count]]
                earlier, later = (
                    np.abs(middle - begin).max(),
                    np.abs(end - middle).max(),
                )
                if has_settled(earlier, later, drift_tolerance(self.tol)):
                    period[i] = times[late][lag] - times[late][0]
        return period, silent

    def _without_events(
        self, rows: np.ndarray, spans: np.ndarray, steps: np.ndarray
    ) -> np.ndarray:
        """Times after which an autonomous motion without events is back at its state."""
        half = self.run(rows, times=np.array([0.5 * self.duration]))
        states, regimes = half["samples"][:, 0], half["sample_regimes"][:, 0]

        def at(which: np.ndarray, times: np.ndarray) -> np.ndarray:
            """States over their ranges at times after the middle of the run."""
            named = dict(zip(self.system.states, states[which].T, strict=True))
            options = {
                "states": named,
                "regime": regimes[which],
                "times": times,
                "t_start": self.t_start + 0.5 * self.duration,
            }
            run = self.run(rows[which], 0.5, **options)
            return np.asarray(run["samples"] / spans[which, None])

        every = np.arange(rows.size)
        window = (
            0.5
            * self.duration
            * np.minimum(1.0, 2.0 * limits.samples / limits.samples_per_step / steps)
        )
        times = window[:, None] * np.linspace(0.0, 1.0, limits.samples)
        path = at(every, times)
        begin = path[:, :1]
        normal = path[:, 1] - path[:, 0]
        returns = [
            _near_returns(*each) for each in zip(times, path, normal, strict=True)
        ]
        period = np.full(rows.size, np.nan)
        for number in range(limits.tries):
            which = np.array(
                [i for i in every if np.isnan(period[i]) and len(returns[i]) > number],
                int,
            )
            if not which.size:
                break

            def back_at(time: np.ndarray, width: np.ndarray, which: Any = which) -> Any:
                """Return when motions cross the plane through their states, next to these times."""
                for _ in range(3):
                    places = time[:, None] + width[:, None] * np.linspace(-1.0, 1.0, 9)
                    places = np.clip(places, 0.0, 0.5 * self.duration)
                    near = at(which, places) - begin[which]
                    heights = (near * normal[which, None]).sum(axis=2)
                    time = _zeros(places, heights, time)
                    width = width / 200.0
                return time

            time = np.array([returns[i][number] for i in which])
            time = back_at(time, window[which] / (limits.samples - 1))
            again = time[:, None] * np.arange(1, Recurrence.least_repeats + 1)
            fits = again[:, -1] <= 0.5 * self.duration
            again = np.minimum(again, 0.5 * self.duration)
            off = np.abs(at(which, again) - begin[which]).max(axis=(1, 2))
            repeats = fits & (off <= Recurrence.repeated)
            if repeats.any():
                rounds = np.maximum(0.25 * self.duration // time, 1.0)
                later = [back_at(k * rounds * time, 0.25 * time) for k in (1.0, 2.0)]
                places = at(which, np.stack(later, axis=1))
                moved = np.diff(np.hstack([begin[which], places]), axis=1)
                earlier, later = np.abs(moved).max(axis=2).T
                repeats &= has_settled(earlier, later, drift_tolerance(self.tol))
            period[which] = np.where(repeats, time, np.nan)
        return period


def _near_returns(
    times: np.ndarray, path: np.ndarray, normal: np.ndarray
) -> list[float]:
    """Instants at which a sampled motion crosses a plane through its first state near to it."""
    instants, there = crossings(times, path, path[0], normal)
    near = np.abs(there - path[0]).max(axis=1, initial=0.0) < limits.near
    return list(instants[near][: limits.tries])


def _zeros(places: np.ndarray, heights: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the place at which each row first rises through zero; ``other`` where none does."""
    rises = (heights[:, :-1] < 0.0) & (heights[:, 1:] >= 0.0)
    row, at = np.arange(len(places)), np.argmax(rises, axis=1)
    low, high = heights[row, at], heights[row, at + 1]
    share = -low / np.where(high > low, high - low, 1.0)
    zero = places[row, at] + share * (places[row, at + 1] - places[row, at])
    return np.where(rises.any(axis=1), zero, other)
