"""Run starts until they have settled, and say what each has settled to.

Idea: the horizon is no setting. Windows follow one another and grow to twice their length each
time, until two in succession show the same verdict and agree by the rules of
:mod:`squealpipe.vibration.settling`. Near an onset motions grow or decay slowly: a window that is
too short to show this settles nothing. A motion is quiet only where it has become small, or decays
as fast as small motions do; where forces are linear, a window in which no contact switches is such
a decay at any size, and where they nearly are it may be shown to be one. An irregular motion that
other starts have settled to is known again as soon as the last windows together have its
statistics.

Invariant: what moves does not matter here. Pads and structures hand over starts with the growth
rate of their small motions, and a callable that integrates some of them on for a length of time.
Cost: that of the runs; a motion that takes n periods to settle is run for 2 n at most.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from squealpipe.codes import Verdict
from squealpipe.systems.progress import alone, stop_is_asked
from squealpipe.vibration.settling import (
    ALWAYS,
    Agreement,
    Settling,
    agreement,
    difference,
)
from squealpipe.vibration.verdicts import heard
from squealpipe.vibration.windows import Windows


@dataclass(frozen=True)
class Quietness:
    """Thresholds of what has died out; each comment says what another value would do."""

    faded: float = 0.1
    """Velocity over that of the push below which a motion has died out. Half as much: motions that
    decay slowly are run longer; the verdict is the same."""
    stays_small: float = 10.0
    """Velocity over that of the push up to which motions are small: undamped ones that stay below
    are quiet. Twice as much: a small cycle without events may be called quiet."""
    shown: float = 0.5
    """Growth or decay in a window, in logarithm, from which it would be seen. Half as much: what
    grows slowly may pass for settled."""
    seen: float = 1.0
    """Decay, in logarithm, that two states cannot pretend by their phases. Half as much: a beat may
    pass for a decay."""
    decay_share: float = 0.5
    """Share of the decay of small motions that a motion has to show. At 1 beats would hide it."""


@dataclass(frozen=True, kw_only=True)
class Start:
    """A start, and what is known of small motions about its steady sliding.

    Attributes:
        subject: what moves, for the callable that runs it.
        state: where it starts, (states,).
        sliding: state of steady sliding; None if there is none.
        period: unit of the lengths of its windows, s.
        speed: largest velocity of small motions of the size of the push, in the unit of the
            windows' velocities; of an undamped subject that of this start.
        rate: growth rate of small motions, 1/s; 0 where no run would show growth or decay.
        is_linear: whether motions during which no contact switches decay as small ones do.
        is_led: whether it is where a motion lasts at another value of a parameter. Its windows need
            not be so long that they show how slowly small motions grow.
        measure: size of a deviation (states,) as a velocity.
    """

    subject: Any
    state: np.ndarray
    sliding: np.ndarray | None
    period: float
    speed: float
    rate: float
    is_linear: bool = False
    is_led: bool = False
    measure: Callable[[np.ndarray], float] = field(repr=False)

    def distance(self, state: np.ndarray) -> float:
        """Return how far a state is from steady sliding, as a velocity."""
        return self.measure(state if self.sliding is None else state - self.sliding)


@dataclass(frozen=True)
class SettledRun:
    """Settled motion of one start.

    Attributes:
        verdict: on the motion; undetermined where it has not settled.
        last: statistics of the last window.
        elapsed: time run, s.
        irregular: whether its numbers are statistics.
        change: largest difference of the last window to the one before; infinite where they do not
            agree.
        windows: all of them.
        arrived: whether it has come to a known motion. Its last window, of several merged, may
            begin with the end of a transient.
        unbounded: whether it has grown beyond all that contacts limit.
    """

    verdict: Verdict
    last: Any
    elapsed: float
    irregular: bool = False
    change: float = 0.0
    windows: Sequence[Any] = ()
    arrived: bool = False
    unbounded: bool = False

    @property
    def quiet(self) -> bool:
        """True if it has died out to steady sliding."""
        return self.verdict is Verdict.quiet

    @property
    def agrees(self) -> bool:
        """True if it has settled at all."""
        return self.verdict is not Verdict.undetermined

    @property
    def sticks_for_good(self) -> bool:
        """True if a contact has not been seen to slip again: the belt carries it ever farther."""
        return self.last is not None and bool((self.last.stuck >= ALWAYS).any())

    @property
    def lasts(self) -> bool:
        """True if a motion is known to last, or has at least not lost its events by the horizon.

        What slides in contact by then, and has only not become small, dies out with small motions.
        """
        if self.verdict is Verdict.undetermined:
            return bool(self.last.switched or not self.last.finished or self.unbounded)
        return not self.quiet


@dataclass(frozen=True)
class Horizon:
    """Lengths of windows, (runs,) each, s.

    Attributes:
        first, second: lengths of the first two windows; later ones double.
        most: time after which a motion that has not settled is undetermined.
        growth_windows: number of first windows, of equal length, in which a push grows: no
            statistics of them are compared with each other.
    """

    first: np.ndarray
    second: np.ndarray
    most: np.ndarray
    growth_windows: int = 0

    @classmethod
    def of(cls, starts: Sequence[Start], most_periods: float) -> Self:
        """Return the lengths for starts whose small motions grow to e^½ in the first window."""
        period = np.array([start.period for start in starts])
        rates = [
            0.0 if start.is_led else abs(start.rate) * start.period for start in starts
        ]
        shown = [Quietness.shown / rate if rate > 0 else 0.0 for rate in rates]
        # in periods of the slowest mode that grows, or of any; twice as many take twice as long
        # where the motion settles at once
        fewest_periods = 50.0
        first = np.clip(shown, fewest_periods, 0.25 * most_periods) * period
        return cls(first, first, most_periods * period)


Advance = Callable[[list[int], np.ndarray, "np.ndarray | None", np.ndarray, int], Any]
"""Run some starts on: their numbers, states (runs, states), regimes (runs, components; None: what
fits), lengths of time (runs,), and the number of the window; returns :class:`Windows`."""
Told = Callable[[dict[int, SettledRun], np.ndarray], None]


def settle(
    starts: Sequence[Start],
    advance: Advance,
    horizon: Horizon,
    rules: Settling,
    *,
    regimes: np.ndarray | None = None,
    told: Told | None = None,
    second: Callable[[int, Any], float] | None = None,
    known: Sequence[SettledRun] = (),
    merged: Callable[[Sequence[Any]], Any] | None = None,
) -> list[SettledRun]:
    """Run starts side by side until each has settled by the rules, or the time has passed.

    Args:
        regimes: those in which they start, (runs, components); None: what fits.
        told: takes what has settled so far and the times run, after each window.
        second: length of a start's second window, or of the first one in which nothing grows any
            more, by its number and the window before, s; None: that of the horizon.
        known: irregular motions of the same subject that have settled. A start whose last windows
            together have the statistics of such a motion has come to it, and is not run on.
        merged: merges windows of one run that follow one another; needed where motions are known.
    """
    count = len(starts)
    settled: dict[int, SettledRun] = {}
    states = np.array([start.state for start in starts])
    elapsed = np.zeros(count)
    length = np.array(horizon.first, float)
    windows: list[list[Windows]] = [[] for _ in range(count)]
    turn = 0
    with alone() as show:
        while rows := [row for row in range(count) if row not in settled]:
            if stop_is_asked():
                settled |= _stopped(rows, windows, elapsed)
                break
            if told is not None:  # the share of one of many searches would tell nothing
                # most settle within a few windows, thousands of times sooner than they have to:
                # the time left is told as if each settled within its next one
                way = elapsed[rows] / (elapsed[rows] + length[rows])
                show(1.0 - len(rows) / count * (1.0 - float(way.mean())))
            begun = None if regimes is None else regimes[rows]
            ran = advance(rows, states[rows], begun, length[rows], turn)
            if regimes is None:
                regimes = np.zeros((count, ran.regimes.shape[1]), ran.regimes.dtype)
            elapsed[rows] += length[rows]
            growing, whole = horizon.growth_windows, []
            for index, row in enumerate(rows):
                now = ran.row(index)
                windows[row].append(now)
                if stop_is_asked() and now.length < (1.0 - 1e-9) * length[row]:
                    # cut short: shown, not judged
                    elapsed[row] += float(now.length) - length[row]
                    continue
                states[row], regimes[row] = now.final, now.regimes
                whole.append(row)
                run = _judged(starts[row], windows[row], rules, growing)
                _keep(settled, row, run, windows[row], elapsed[row])
            if told is not None:
                told(settled, elapsed)
            # another start may have come to a motion that has just settled: no window more for it
            late = elapsed >= (1.0 - 1e-9) * horizon.most
            for row in [row for row in whole if row not in settled]:
                run = _arrived(starts[row], windows[row], known, rules, merged)
                run = run or _unsettled(starts[row], windows[row], growing, late[row])
                _keep(settled, row, run, windows[row], elapsed[row])
            turn += 1
            length = _next_lengths(length, turn, windows, horizon, second)
            length = np.minimum(length, horizon.most - elapsed)
    return [settled[row] for row in range(count)]


def _keep(
    settled: dict[int, SettledRun],
    row: int,
    run: SettledRun | None,
    windows: Sequence[Any],
    elapsed: float,
) -> None:
    """Keep a run that has settled, with all its windows and the time that they took, s."""
    if run is not None:
        settled[row] = replace(run, elapsed=float(elapsed), windows=windows)


def _next_lengths(
    lengths: np.ndarray,
    turn: int,
    windows: list[list[Any]],
    horizon: Horizon,
    second: Callable[[int, Any], float] | None,
) -> np.ndarray:
    """Return the lengths of the windows of a turn, by those of the turn before."""
    if turn < horizon.growth_windows:
        return lengths
    if turn > max(horizon.growth_windows, 1):
        return 2.0 * lengths
    if second is None:
        return horizon.second.astype(float)
    return np.array([second(row, ran[-1]) for row, ran in enumerate(windows)])


def _stopped(
    rows: list[int], windows: list[list[Windows]], elapsed: np.ndarray
) -> dict[int, SettledRun]:
    """Return runs that are stopped before they have settled.

    Raises:
        KeyboardInterrupt: there is no window yet.
    """
    if not all(windows[row] for row in rows):
        raise KeyboardInterrupt
    return {
        row: SettledRun(
            Verdict.undetermined,
            windows[row][-1],
            float(elapsed[row]),
            change=np.inf,
            windows=windows[row],
        )
        for row in rows
    }


def _judged(
    start: Start, windows: list[Any], rules: Settling, growth_windows: int
) -> SettledRun | None:
    """Return what two windows in succession show; None if they show nothing yet.

    Args:
        growth_windows: number of the first windows, which are compared with nothing.
    """
    now = windows[-1]
    if _is_unbounded(start, now.final):
        return SettledRun(Verdict.undetermined, now, 0.0, change=np.inf, unbounded=True)
    before = windows[-2] if len(windows) > growth_windows + 1 else None
    if not now.finished:
        return None
    quiet = SettledRun(Verdict.quiet, now, 0.0)
    if _surely_dies_out(start, now):
        return quiet
    if before is None:
        return None
    fades = not now.switched and start.rate <= 0.0
    if fades and _dies_out(start, before, now):
        return quiet
    levels = before.levels(start.period), now.levels(start.period)
    shown = agreement(*levels, rules)
    verdict = heard(now.losses)
    if heard(before.losses) is not verdict or shown is Agreement.none:
        return None
    run = SettledRun(
        verdict, now, 0.0, shown is Agreement.irregular, difference(*levels)
    )
    carried = run.sticks_for_good  # which is no settled motion
    if verdict is Verdict.hammers:
        return None if carried else run
    if _lost_in_part(now):
        return None
    faded = Quietness.faded * start.speed
    if start.sliding is None and now.total < faded:
        return replace(run, verdict=Verdict.quiet)
    is_shown = abs(start.rate) * float(now.length) >= Quietness.shown or now.switched
    lasts = is_shown or start.rate == 0.0
    return run if lasts and not carried else None


def _is_unbounded(start: Start, state: np.ndarray) -> bool:
    """Tell whether a state is so far from steady sliding that no contact limits its motion."""
    # velocity over that of the push: the preloads' part in so large forces is below round-off
    beyond = 1e12
    with np.errstate(over="ignore", invalid="ignore"):
        return start.speed > 0.0 and not start.distance(state) < beyond * start.speed


def _arrived(
    start: Start,
    windows: list[Any],
    known: Sequence[SettledRun],
    rules: Settling,
    merged: Callable[[Sequence[Any]], Any] | None,
) -> SettledRun | None:
    """Return the end of a start that has come to a known motion; None if it has not.

    The last windows are merged, up to the length of the known motion's. They have to agree
    whichever comes first: a component that still decays, and one that has yet to grow, are both
    seen.
    """
    if merged is None or not windows[-1].finished:
        return None
    for motion in known:
        then = motion.last.levels(start.period)
        for count in range(1, len(windows) + 1):
            last = merged(windows[-count:])
            levels = last.levels(start.period)
            ways = agreement(then, levels, rules), agreement(levels, then, rules)
            if Agreement.none not in ways and heard(last.losses) is motion.verdict:
                change = difference(then, levels)
                return SettledRun(
                    motion.verdict, last, 0.0, motion.irregular, change, arrived=True
                )
            if last.length >= motion.last.length:
                break
    return None


def _unsettled(
    start: Start, windows: list[Any], growth_windows: int, late: bool
) -> SettledRun | None:
    """Return the run of a motion that ends without having settled; None if it goes on.

    Args:
        late: whether its horizon is reached.
    """
    now, compared = windows[-1], len(windows) > growth_windows + 1
    if now.finished and not late:
        return None
    if now.finished and compared and _decays(start, windows[-2], now):
        return SettledRun(Verdict.quiet, now, 0.0)  # too slowly to become small
    return SettledRun(Verdict.undetermined, now, 0.0, change=np.inf)


def _lost_in_part(now: Windows) -> bool:
    """Tell whether contact is lost for a part of the window, or at all contacts.

    A single contact of many may stay open in a settled motion.
    """
    in_part = (now.separated > 0.0) & (now.separated < ALWAYS)
    return bool(now.losses or in_part.any() or (now.separated >= ALWAYS).all())


def _surely_dies_out(start: Start, now: Windows) -> bool:
    """Tell whether linear forces, or the decay that was seen, leave no doubt at any size."""
    is_linear_decay = start.is_linear and start.rate < 0.0 and not now.switched
    return bool(is_linear_decay or now.fades)


def _dies_out(start: Start, before: Windows, now: Windows) -> bool:
    """Tell whether a motion without events is small and decays as small motions do."""
    largest = float(now.largest_velocity)
    if largest > Quietness.stays_small * start.speed:
        # a long window may begin loud: a part of the decay within it has to be seen
        decay = Quietness.decay_share * start.rate * float(now.length)
        left = min(Quietness.stays_small * start.speed, largest * np.exp(decay))
        return bool(decay < -Quietness.seen and start.distance(now.final) < left)
    if largest < Quietness.faded * start.speed or start.rate == 0.0:
        return True
    return _decays(start, before, now)


def _decays(start: Start, before: Windows, now: Windows) -> bool:
    """Tell whether two windows without events show a part of the decay of small motions."""
    if start.rate >= 0.0 or before.switched or now.switched:
        return False
    # from the middle of one window to that of the next
    apart = 0.5 * float(before.length + now.length)
    return bool(
        now.total < before.total * np.exp(Quietness.decay_share * start.rate * apart)
    )
