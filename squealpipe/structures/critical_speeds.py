"""Speeds of the belt or of the rotation at which a mode turns unstable or stable.

Modes are followed along the speed as they are along friction (:mod:`.numbering`), with the matrices
and the steady sliding of each speed, and the first speed at which growth passes zero is located as
a critical friction is (:mod:`.onset`). A mode may pass zero twice between two speeds: where the
tangents of its growth at both meet beyond zero a speed is added between. On the way the speed is
divided by the largest, so that one tolerance serves for m/s and rad/s.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from squealpipe.structures.following import successors
from squealpipe.structures.numbering import Step, Way
from squealpipe.structures.onset import onset
from squealpipe.structures.pencil import Pencil
from squealpipe.structures.refinement import Eigenpair
from squealpipe.structures.schema.structures import SpeedOnset
from squealpipe.structures.sliding import NoSlidingError, SteadySliding
from squealpipe.structures.spectrum import Solver, Spectrum


class CriticalSpeed(NamedTuple):
    """The first speed at which growth of a mode passes zero.

    Attributes:
        speed: m/s or rad/s, NaN if there is none.
        onset: what happens there, or why there is none.
    """

    speed: float
    onset: SpeedOnset


@dataclass
class SpeedSolver(Solver):
    """Modes at one friction and any speed; remembers them.

    Attributes:
        mu: friction.
        unit: speed of which the argument of all methods is a multiple.
    """

    mu: float = 0.0
    unit: float = 1.0
    _solvers: dict[float, Solver] = field(default_factory=dict)

    def _at(self, share: float) -> Solver:
        if share not in self._solvers:
            try:
                structure = self.structure.at_speed(share * self.unit)
            except ValueError as error:  # a term has no value at speed 0
                raise NoSlidingError(str(error)) from error
            self._solvers[share] = Solver(
                structure, self.limits, share * self.unit, self.varied
            )
        return self._solvers[share]

    def sliding(self, mu: float) -> SteadySliding:
        """Steady sliding at a share of the unit."""
        return self._at(mu).sliding(self.mu)

    def pencil(self, mu: float) -> Pencil:
        """Return the matrices of small motions at a share of the unit of speed."""
        return self._at(mu).pencil(self.mu)

    def at(self, mu: float) -> Spectrum:
        """Modes at a share of the unit."""
        return self._at(mu).at(self.mu)


def critical_speeds(
    ways: list[Way], speeds: np.ndarray, mu: float, numbers: list[int]
) -> list[CriticalSpeed]:
    """Return where growth of each mode first passes zero as the speed rises.

    Args:
        ways: modes along friction at each of the speeds.
        speeds: m/s or rad/s.
        mu: friction.
        numbers: of the modes, as the way at the lowest speed has them.
    """
    order = np.argsort(speeds)
    unit = float(np.abs(speeds).max())
    start = next((ways[each] for each in order if mu in ways[each].steps), None)
    if start is None or not unit:
        return [CriticalSpeed(np.nan, SpeedOnset.not_followed) for _ in numbers]
    solver = start.solver
    along = _followed(
        SpeedSolver(
            solver.structure,
            solver.limits,
            solver.belt_speed,
            solver.varied,
            None,
            mu=mu,
            unit=unit,
        ),
        (speeds[order] / unit).tolist(),
    )
    if not along.steps:
        return [CriticalSpeed(np.nan, SpeedOnset.not_followed) for _ in numbers]
    first, step = next(iter(along.steps.values())), start.steps[mu]
    places, _ = successors(step.spectrum, first.spectrum)
    number_along = {
        int(number): int(first.numbers[place])
        for number, place in zip(step.numbers, places, strict=True)
        if place >= 0
    }
    return [
        _first_change(along, number_along[number], unit)
        if number in number_along
        else CriticalSpeed(np.nan, SpeedOnset.not_followed)
        for number in numbers
    ]


def _followed(solver: SpeedSolver, shares: list[float]) -> Way:
    """Return the modes along the speed, also where one may grow for a while between two shares."""
    # how often a step may be divided; each time it is about three times as short
    most_divisions = 5
    for division in range(most_divisions + 1):
        along = Way(solver)
        along.follow(shares, None)
        between = [
            share
            for (low, before), (high, after) in pairwise(along.steps.items())
            if (share := _may_turn(along, (low, before), (high, after))) is not None
        ]
        if not between or division == most_divisions:
            break
        shares = sorted({*shares, *between})
    return along


def _may_turn(
    along: Way, before: tuple[float, Step], after: tuple[float, Step]
) -> float | None:
    """Return where the growth of a mode may have passed zero and come back; None if none may."""
    (low, first), (high, second) = before, after
    common = [
        number
        for number in map(int, first.numbers)
        if second.place(number) is not None
        and (along.grown(first, number) is None)
        == (along.grown(second, number) is None)
    ]
    if not common:
        return None
    one, other = (
        [pair for number in common if (pair := step.pair(number)) is not None]
        for step in (first, second)
    )
    length = high - low
    starts, ends = (np.array([pair.value.real for pair in row]) for row in (one, other))
    # towards zero of modes that grow is down
    sign = np.where(starts > 0, -1.0, 1.0)
    starts, ends = sign * starts, sign * ends
    try:
        rises = sign * length * _slopes(along.solver, low, one, length)
        falls = sign * length * _slopes(along.solver, high, other, -length)
    except NoSlidingError:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        meet = (ends - falls - starts) / (rises - falls)
        tops = starts + rises * meet
    errors = np.array([max(a.error, b.error) for a, b in zip(one, other, strict=True)])
    turns = (rises > 0) & (falls < 0) & (tops > errors) & (starts < 0) & (ends < 0)
    if not turns.any():
        return None
    place = float(meet[np.argmax(np.where(turns, tops, -np.inf))])
    return low + length * min(max(place, 0.1), 0.9)


def _slopes(
    solver: Solver, share: float, pairs: list[Eigenpair], length: float
) -> np.ndarray:
    """Return how growth changes with the share of the speed, towards one side."""
    # part of the step over which the matrices are differentiated
    step = 1e-5 * length
    here, there = solver.pencil(share), solver.pencil(share + step)
    s = np.array([pair.value for pair in pairs])
    right, left = (
        np.stack([getattr(pair, name) for pair in pairs], axis=1)
        for name in ("right", "left")
    )
    damping = there.rate(0.0, right) - here.rate(0.0, right)
    stiffness = there.stiffness @ right - here.stiffness @ right
    change = np.sum(left.conj() * (s * damping + stiffness), axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.sum(left.conj() * here.rate(s, right), axis=0)
        return np.asarray((-change / rate).real / step)


def _first_change(along: Way, number: int, unit: float) -> CriticalSpeed:
    """Return where one mode first turns unstable or stable."""
    last: tuple[float, Eigenpair, bool] | None = None
    for share, step in along.steps.items():
        pair = step.pair(number)
        if pair is None:
            continue
        grown = along.grown(step, number)
        grows, pair = grown is not None, grown or pair
        if last is not None and grows != last[2]:
            return _located(along, last, (share, pair, grows), unit)
        last = share, pair, grows
    if last is None:
        return CriticalSpeed(np.nan, SpeedOnset.not_followed)
    return CriticalSpeed(
        np.nan, SpeedOnset.unstable_throughout if last[2] else SpeedOnset.stable
    )


def _located(
    along: Way,
    before: tuple[float, Eigenpair, bool],
    after: tuple[float, Eigenpair, bool],
    unit: float,
) -> CriticalSpeed:
    """Return the speed between two at one of which a mode grows."""
    grows = after[2]
    # a mode that turns stable does the opposite on the way back
    sign = 1.0 if grows else -1.0
    stable, unstable = (before, after) if grows else (after, before)
    crossing = onset(
        lambda share: along.solver.pencil(sign * share),
        (sign * stable[0], stable[1]),
        (sign * unstable[0], unstable[1]),
    )
    if crossing is None:
        return CriticalSpeed(np.nan, SpeedOnset.not_followed)
    turn = SpeedOnset.turns_unstable if grows else SpeedOnset.turns_stable
    return CriticalSpeed(sign * crossing.mu * unit, turn)
