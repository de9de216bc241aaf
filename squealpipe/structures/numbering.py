"""Follow the modes of a structure along friction, each with a number that it keeps.

Idea: two neighbouring frictions are matched by overlap of left and right eigenvectors; where the
match is not clear the step is halved. Contacts that open or close in between bend the branches, so
steps end there. The onset of a mode is the friction at which its growth passes zero, located
between two steps; without damping it is where two modes merge. Invariant: a number is given once,
and never to two modes of one friction. Cost: one eigenvalue problem for each friction, and some ten
more for each onset.
"""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from squealpipe.structures.following import followed, successors
from squealpipe.structures.onset import Crossing, onset
from squealpipe.structures.refinement import Eigenpair
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.sliding import NoSlidingError, changes
from squealpipe.structures.spectrum import Solver, Spectrum
from squealpipe.systems.progress import with_progress


@dataclass(frozen=True)
class Step:
    """One friction on the way.

    Attributes:
        numbers: of the modes of the spectrum, (modes,).
    """

    spectrum: Spectrum
    numbers: np.ndarray

    def place(self, number: int) -> int | None:
        """Return the index of the mode with a number, or None if it is not among these."""
        return self._places.get(number)

    @cached_property
    def _places(self) -> dict[int, int]:
        return {number: place for place, number in enumerate(self.numbers.tolist())}

    def pair(self, number: int) -> Eigenpair | None:
        """The mode of a number."""
        place = self.place(number)
        return None if place is None else self.spectrum.pairs[place]


class Critical(NamedTuple):
    """Onset of one mode: the friction at which it turns unstable.

    Attributes:
        mu: friction, NaN if there is none.
        onset: why.
        partner: the mode that it meets by frequency, if there is one.
        crossing: what was found there.
    """

    mu: float
    onset: Onset
    partner: int | None = None
    crossing: Crossing | None = None


@dataclass
class Way:
    """Modes along friction at one belt speed.

    Attributes:
        top: first number that no mode has, of this way or of those before.
        between: whether frictions between those asked for are computed, too: they keep the numbers
            of modes right and locate critical frictions.
        steps: by friction, those between the frictions asked for included.
        reasons: why there is no steady sliding at some.
    """

    solver: Solver
    top: int = 0
    between: bool = True
    steps: dict[float, Step] = field(default_factory=dict)
    reasons: list[str] = field(default_factory=list)
    _onsets: dict[tuple[int, float, float], Crossing | None] = field(
        default_factory=dict
    )

    def follow(self, frictions: list[float], after: "Way | None") -> None:
        """Number the modes at these frictions, ascending; the first as those of another way."""
        last: float | None = None
        for mu in with_progress(frictions):
            try:
                spectrum = self.solver.at(mu)
            except NoSlidingError as error:
                self.reasons.append(str(error))
                continue
            if last is None:
                self.steps[mu] = Step(spectrum, self._first_numbers(spectrum, after))
            else:
                self._go(last, mu)
            last = mu

    def _first_numbers(self, spectrum: Spectrum, after: "Way | None") -> np.ndarray:
        if after is None or not after.steps:
            nowhere = np.full(0, -1)
            return self._carried(nowhere, nowhere, len(spectrum.pairs))
        before = next(iter(after.steps.values()))
        places, _ = successors(before.spectrum, spectrum)
        return self._carried(before.numbers, places, len(spectrum.pairs))

    def _go(self, low: float, high: float) -> None:
        """Follow the modes to the next friction, past each at which contacts open or close."""
        solver = self.solver
        if not self.between:
            start, spectrum = self.steps[low], solver.at(high)
            places, _ = successors(start.spectrum, spectrum)
            numbers = self._carried(start.numbers, places, len(spectrum.pairs))
            self.steps[high] = Step(spectrum, numbers)
            return
        try:
            passed = changes(solver.sliding, low, high)
        except NoSlidingError:
            passed = []
        stations = [*(mu for pair in passed for mu in pair), high]
        for station in stations:
            if station > low:
                self._go_smoothly(low, station)
                low = station

    def _go_smoothly(self, low: float, high: float, halvings: int = 4) -> None:
        start, top = self.steps[low], self.top
        passed = {low: start}
        for mu, places in followed(self.solver.at, low, high, self.solver.selected):
            spectrum = self.solver.at(mu)
            numbers = self._carried(start.numbers, places, len(spectrum.pairs))
            passed[mu] = Step(spectrum, numbers)
        middle = 0.5 * (low + high)
        if halvings and self._loses_one(passed) and self._slides(middle):
            # modes took each other's numbers, or were stable for less than this step
            self.top = top
            self._go_smoothly(low, middle, halvings - 1)
            self._go_smoothly(middle, high, halvings - 1)
            return
        self.steps.update(passed)

    def _slides(self, mu: float) -> bool:
        try:
            self.solver.at(mu)
        except NoSlidingError:
            return False
        return True

    def _loses_one(self, passed: dict[float, Step]) -> bool:
        """Return whether a mode within the limits cannot be followed to where it turns unstable."""
        for (low, before), (high, after) in pairwise(passed.items()):
            within = after.numbers[self.solver.selected(after.spectrum)]
            for number in map(int, within):
                pair = before.pair(number)
                if pair is None or self.grown(before, number) is not None:
                    continue
                grown = self.grown(after, number)
                if grown is None:
                    continue
                if self._onset(number, (low, pair), (high, grown)) is None:
                    return True
        return False

    def _onset(
        self,
        number: int,
        stable: tuple[float, Eigenpair],
        grown: tuple[float, Eigenpair],
    ) -> Crossing | None:
        """Return the friction between two at which a mode turns unstable; None where it cannot be
        followed.
        """
        key = number, stable[0], grown[0]
        if key not in self._onsets:
            self._onsets[key] = onset(self.solver.pencil, stable, grown)
        return self._onsets[key]

    def grown(self, step: Step, number: int) -> Eigenpair | None:
        """The mode if it grows, or the one that it has merged with; None if neither does."""
        pair, twin = step.pair(number), self._twin(step, number)
        if pair is None or not (pair.value.real > pair.error or twin is not None):
            return None
        return pair if twin is None or pair.value.real > 0 else step.pair(twin)

    def _carried(
        self, numbers: np.ndarray, places: np.ndarray, size: int
    ) -> np.ndarray:
        """Numbers at the places that modes went to; new ones elsewhere."""
        carried = np.full(size, -1)
        kept = places >= 0
        carried[places[kept]] = numbers[kept]
        new = carried < 0
        carried[new] = self.top + np.arange(new.sum())
        self.top += int(new.sum())
        return carried

    def criticals(self, numbers: list[int]) -> list[Critical]:
        """Return the friction at which growth of each of these modes leaves zero, and the mode that
        it meets.
        """
        if not self.between:
            return [Critical(np.nan, Onset.not_sought) for _ in numbers]
        criticals = {number: self.critical(number) for number in numbers}
        # where damping lets one of two that meet grow alone, the other has met it all the same
        meeting = [
            number for number in numbers if criticals[number].partner is not None
        ]
        for number in sorted(meeting, key=lambda each: criticals[each].mu):
            partner = criticals[number].partner
            if partner in criticals and criticals[partner].partner is None:
                criticals[partner] = criticals[partner]._replace(partner=number)
        return list(criticals.values())

    def critical(self, number: int) -> Critical:
        """Return the friction at which growth of one mode leaves zero."""
        last: tuple[float, Eigenpair] | None = None
        for mu, step in self.steps.items():
            pair = step.pair(number)
            if pair is None:
                continue
            grown = self.grown(step, number)
            if grown is None:
                last = mu, pair
                continue
            if last is None:
                # a mode that is new here, as beyond frictions that jam, has no earlier one
                is_first = step is next(iter(self.steps.values()))
                reason = Onset.unstable_throughout if is_first else Onset.not_followed
                return Critical(np.nan, reason)
            located = self._onset(number, last, (mu, grown))
            if located is None:
                return Critical(np.nan, Onset.not_followed)
            twin = self._twin(step, number)
            partner = self._nearest(step, number) if twin is None else twin
            return Critical(located.mu, Onset.located, partner, located)
        return Critical(np.nan, Onset.stable)

    def _twin(self, step: Step, number: int) -> int | None:
        """The mode with the opposite growth and the same frequency, without damping."""
        place = step.place(number)
        if place is None or not step.spectrum.pencil.is_undamped:
            return None
        value, error = step.spectrum.values[place], step.spectrum.errors[place]
        if abs(value.real) <= error or value.imag == 0:
            return None
        same = np.abs(step.spectrum.values + value.conjugate()) <= 2 * error
        twins = step.numbers[same & (np.arange(len(same)) != place)]
        return int(twins[0]) if twins.size else None

    def _nearest(self, step: Step, number: int) -> int | None:
        """The mode that came near by frequency, if one did."""
        first = next(iter(self.steps.values()))
        now, then = (
            dict(zip(at.numbers.tolist(), at.spectrum.values.imag, strict=True))
            for at in (step, first)
        )
        own = now.pop(number)
        if own == 0 or number not in then:
            return None
        other = min(now, key=lambda each: abs(now[each] - own), default=None)
        if other is None or other not in then:
            return None
        distance = abs(then[other] - then[number])
        # two modes merge where their frequencies come nearer than half of their first distance
        return other if abs(now[other] - own) < 0.5 * distance else None
