"""Speeds of the belt or of the rotation at which a mode turns unstable or stable.

Modes are followed along the speed as they are along friction (:mod:`.numbering`), with the matrices
and the steady sliding of each speed, and the first speed at which growth passes zero is located as
a critical friction is (:mod:`.onset`). On the way the speed is divided by the largest, so that one
tolerance serves for m/s and rad/s.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from squealpipe.structures.following import successors
from squealpipe.structures.numbering import Way
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
    along = Way(
        SpeedSolver(
            solver.structure,
            solver.limits,
            solver.belt_speed,
            solver.varied,
            None,
            mu=mu,
            unit=unit,
        )
    )
    along.follow((speeds[order] / unit).tolist(), None)
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
