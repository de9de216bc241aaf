"""What a start settles to: windows of growing length, until two in succession agree.

The horizon is no setting. Windows follow one another and grow to twice their length each time,
until the kind of motion in two of them is the same and their statistics agree, or ``MOST`` periods
have passed. Near an onset motions grow or decay slowly: a window that is too short to show this
settles nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from squealpipe.methods.progress import alone
from squealpipe.models.damped import is_undamped
from squealpipe.schema.assess import Verdict
from squealpipe.tasks.assess.sliding import Design, Sliding
from squealpipe.tasks.assess.windows import Windows, run_windows
from squealpipe.vibration.settling import FOR_VERDICTS, Agreement, Settling, agreement
from squealpipe.vibration.verdicts import heard

PUSH = 0.01
"""Push of steady sliding, over the static compression."""
FIRST = 50.0
"""Length of the first two windows, in periods."""
MOST = 20_000.0
"""Periods after which a motion that has not settled is undetermined."""
FADED = 0.1
"""Velocity, over that of the push, below which a motion has died out."""
BELOW = 10.0
"""Velocity, over that of the push, up to which the motion of an undamped brake is quiet."""
SHOWN = 0.5
"""Growth or decay within a window, in logarithm, from which it would be seen."""
SEEN = 1.0
"""Decay, in logarithm, that two states cannot pretend by their phases."""


@dataclass(frozen=True)
class Start:
    """A start of a design.

    Attributes:
        state: (4,), m and m/s.
        sliding: steady sliding of the design, if there is any.
        speed: largest speed of small motions of the size of the push, m/s; of an undamped brake
            that of this start.
    """

    design: Design
    state: np.ndarray
    sliding: Sliding | None
    speed: float

    @property
    def rate(self) -> float:
        """Growth rate of small motions, 1/s; 0 for no growth or a decay that no run shows."""
        if self.sliding is None:
            return 0.0
        rate = self.sliding.growth_rate
        fades = rate < -self.sliding.marginal
        return rate if fades or self.sliding.is_unstable else 0.0

    def size(self, state: np.ndarray) -> float:
        """How far a state is from steady sliding, m/s."""
        rest = np.zeros(4) if self.sliding is None else self.sliding.state
        away = state - rest
        return float(np.hypot(*away[:2]) * self.design.rate + np.hypot(*away[2:]))


@dataclass(frozen=True)
class Settled:
    """What a start has settled to.

    Attributes:
        last: statistics of the last window.
        time: time by which it had settled, s.
        irregular: whether its numbers are statistics.
    """

    verdict: Verdict
    last: Windows
    time: float
    irregular: bool = False

    @property
    def lasts(self) -> bool:
        """Whether a motion is known to last, or has at least not lost its events by the horizon.

        What slides in contact by then, and has only not become small, dies out with small motions.
        """
        if self.verdict is Verdict.undetermined:
            return bool(self.last.nonlinear or not self.last.finished)
        return self.verdict is not Verdict.quiet


def pushed(design: Design, sliding: Sliding) -> Start:
    """Steady sliding, pushed in the direction in which small motions grow fastest."""
    size = PUSH * (design.params.preload - sliding.state[1])
    speed = size * float(np.linalg.norm(sliding.push[2:]))
    speed = max(speed, size * design.rate)
    return Start(design, sliding.state + size * sliding.push, sliding, speed)


def start_at(design: Design, sliding: Sliding | None, state: np.ndarray) -> Start:
    """Another start."""
    size, rest = design.params.preload, np.zeros(4)
    if sliding is not None:
        size, rest = design.params.preload - sliding.state[1], sliding.state
    speed = PUSH * size * design.rate
    if is_undamped(design.params):
        away = np.hypot(*(state - rest)[:2]) * design.rate
        speed = max(speed, float(np.hypot(away, np.hypot(*state[2:]))) / BELOW * 2.0)
    return Start(design, np.asarray(state, float), sliding, speed)


def settle(
    starts: Sequence[Start],
    *,
    tol: float,
    most: float = MOST,
    rules: Settling = FOR_VERDICTS,
) -> list[Settled]:
    """Run each start until it has settled by the rules, ``most`` periods at most."""
    settled: dict[int, Settled] = {}
    states = np.array([start.state for start in starts])
    length = np.array([_first_window(start, most) for start in starts])
    period = np.array([start.design.period for start in starts])
    elapsed = np.zeros(len(starts))
    before: dict[int, tuple[Windows, float]] = {}
    while rows := [row for row in range(len(starts)) if row not in settled]:
        seconds = length[rows] * period[rows]
        designs = [starts[row].design for row in rows]
        with (
            alone()
        ):  # how many windows follow is not known: their share would tell nothing
            windows = run_windows(designs, states[rows], seconds, rules, tol=tol)
        elapsed[rows] += length[rows]
        for at, row in enumerate(rows):
            now, start = windows.row(at), starts[row]
            verdict, shown = None, Agreement.none
            if row in before:
                span = float(seconds[at])
                verdict, shown = _judge(start, *before[row], now, span, rules)
                length[row] *= 2.0
            length[row] = min(length[row], most - elapsed[row])
            if verdict is None and (elapsed[row] >= most or not now.finished):
                verdict = Verdict.undetermined
                if now.finished and _decays(start, *before[row], now, seconds[at]):
                    verdict = Verdict.quiet  # too slowly to become small
            if verdict is not None:
                time = float(elapsed[row] * period[row])
                irregular = shown is Agreement.irregular
                settled[row] = Settled(verdict, now, time, irregular)
            before[row], states[row] = (now, float(seconds[at])), now.final
    return [settled[row] for row in range(len(starts))]


def _first_window(start: Start, most: float) -> float:
    """Periods of the first window: small motions grow to e^½ in it, or more."""
    rate = abs(start.rate) * start.design.period
    shown = SHOWN / rate if rate > 0 else 0.0
    return float(np.clip(shown, FIRST, 0.25 * most))


def _judge(
    start: Start,
    before: Windows,
    span: float,
    now: Windows,
    seconds: float,
    rules: Settling = FOR_VERDICTS,
) -> tuple[Verdict | None, Agreement]:
    """The verdict on two successive windows, None: they have not settled; and what they show."""
    undecided = None, Agreement.none
    if not now.finished:
        return undecided
    fades = not now.nonlinear and start.rate <= 0.0
    if fades and _dies_out(start, before, span, now, seconds):
        return Verdict.quiet, Agreement.regular
    last, verdict = (heard(int(each.separations)) for each in (before, now))
    period = start.design.period
    levels = before.levels(span / period), now.levels(seconds / period)
    shown = agreement(*levels, rules)
    if last is not verdict or shown is Agreement.none:
        return undecided
    if verdict is Verdict.hammers:
        return verdict, shown
    if now.separations > 0 or now.separated > 0:
        return undecided
    if start.sliding is None and np.hypot(*now.rms) < FADED * start.speed:
        return Verdict.quiet, shown
    is_shown = abs(start.rate) * seconds >= SHOWN or now.nonlinear
    if not is_shown and start.rate != 0.0:
        return undecided
    return verdict, shown


def _dies_out(
    start: Start, before: Windows, span: float, now: Windows, seconds: float
) -> bool:
    """Whether the motion of a window without events is small and decays as small motions do."""
    if now.peak_speed > BELOW * start.speed:
        # a long window may begin loud: half of the decay within it has to be seen
        decay = 0.5 * start.rate * seconds
        left = min(BELOW * start.speed, now.peak_speed * np.exp(decay))
        return bool(decay < -SEEN and start.size(now.final) < left)
    if now.peak_speed < FADED * start.speed or start.rate == 0.0:
        return True
    return _decays(start, before, span, now, seconds)


def _decays(
    start: Start, before: Windows, span: float, now: Windows, seconds: float
) -> bool:
    """Whether two windows without events show at least half of the decay of small motions."""
    if start.rate >= 0.0 or before.nonlinear or now.nonlinear:
        return False
    # from the middle of one window to that of the next
    decay = 0.5 * start.rate * 0.5 * (span + seconds)
    return bool(np.hypot(*now.rms) < np.hypot(*before.rms) * np.exp(decay))
