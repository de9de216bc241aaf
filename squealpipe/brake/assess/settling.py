"""Starts of a pad, and what they settle to."""

from collections.abc import Sequence

import numpy as np

from squealpipe.brake.assess.fading import Fading
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.assess.windows import run_windows
from squealpipe.brake.models.damped import is_undamped
from squealpipe.brake.schema.assess import KICKS
from squealpipe.vibration.settled_runs import Horizon, Quietness, SettledRun, Start
from squealpipe.vibration.settled_runs import settle as settle_runs
from squealpipe.vibration.settling import Settling, settling_of_verdicts
from squealpipe.vibration.windows import joined

PUSH = 0.01
"""Push of steady sliding, over the static compression."""
MOST_PERIODS_OF_A_PAD = 20_000.0
"""Periods after which a motion that has not settled is undetermined."""


def pushed(design: Design, sliding: Sliding) -> Start:
    """Return steady sliding, pushed in the direction in which small motions grow fastest."""
    size = PUSH * (design.params.preload - sliding.state[1])
    speed = size * float(np.linalg.norm(sliding.push[2:]))
    speed = max(speed, size * design.rate)
    return _start(design, sliding, sliding.state + size * sliding.push, speed)


def start_at(design: Design, sliding: Sliding | None, state: np.ndarray) -> Start:
    """Return another start, at a state (4,), m and m/s."""
    size, rest = design.params.preload, np.zeros(4)
    if sliding is not None:
        size, rest = design.params.preload - sliding.state[1], sliding.state
    speed = PUSH * size * design.rate
    if is_undamped(design.params):
        away = np.hypot(*(state - rest)[:2]) * design.rate
        own = float(np.hypot(away, np.hypot(*state[2:])))
        speed = max(speed, own / Quietness.stays_small * 2.0)
    return _start(design, sliding, np.asarray(state, float), speed)


def strikes(design: Design, sliding: Sliding) -> list[Start]:
    """Return steady sliding, struck."""
    speed = design.params.preload * design.rate
    along = design.params.belt_direction
    return [
        start_at(
            design,
            sliding,
            sliding.state + speed * np.array([0.0, 0.0, along * first, second]),
        )
        for first, second in KICKS
    ]


def _start(
    design: Design, sliding: Sliding | None, state: np.ndarray, speed: float
) -> Start:
    return Start(
        subject=design,
        state=state,
        sliding=None if sliding is None else sliding.state,
        period=design.period,
        speed=speed,
        rate=_rate(sliding),
        measure=lambda away: float(
            np.hypot(*away[:2]) * design.rate + np.hypot(*away[2:])
        ),
    )


def _rate(sliding: Sliding | None) -> float:
    """Growth rate of small motions, 1/s; 0 for no growth or a decay that no run shows."""
    if sliding is None:
        return 0.0
    fades = sliding.growth_rate < -sliding.marginal
    return sliding.growth_rate if fades or sliding.is_unstable else 0.0


def settle(
    starts: Sequence[Start],
    *,
    tol: float,
    most: float = MOST_PERIODS_OF_A_PAD,
    rules: Settling = settling_of_verdicts,
) -> list[SettledRun]:
    """Run each start until it has settled by the rules, ``most`` periods at most."""

    def advance(
        rows: list[int],
        states: np.ndarray,
        regimes: np.ndarray | None,  # noqa: ARG001 (each state of a pad has one)
        seconds: np.ndarray,
        turn: int,  # noqa: ARG001
    ) -> object:
        designs = [starts[row].subject for row in rows]
        probes = Fading.periods * np.array([design.period for design in designs])
        # where nothing but a slow decay may happen a short run shows that
        decays = np.array([starts[row].rate < 0.0 for row in rows])
        slow = np.flatnonzero(decays & (seconds >= Fading.worth * probes))
        if rules.follows_perturbation or not slow.size:
            return run_windows(designs, states, seconds, rules, tol=tol)
        some = [designs[place] for place in slow]
        probed = run_windows(some, states[slow], probes[slow], rules, tol=tol)
        shown = np.flatnonzero(probed.fades)
        left = np.setdiff1d(np.arange(len(rows)), slow[shown])
        parts = [(slow[shown], probed.row(shown))]
        if left.size:
            others = [designs[place] for place in left]
            ran = run_windows(others, states[left], seconds[left], rules, tol=tol)
            parts.append((left, ran))
        return joined(parts)

    return settle_runs(starts, advance, Horizon.of(starts, most), rules)
