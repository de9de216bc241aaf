"""Follow modes of a large structure along friction in a subspace, and confirm them in the whole.

Idea: the modes at two frictions span those in between to high accuracy, so they are followed in
that small space; at each friction that is asked for, each is confirmed in the whole by its residual
and refined. Invariant: what is returned was refined in the whole structure. Cost: one factorization
of the whole for each group of near modes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from squealpipe.structures.following import successors
from squealpipe.structures.numbering import Critical, Step, Way
from squealpipe.structures.onset import Crossing, confirmed, grows
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.refinement import unit_vector
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.sliding import NoSlidingError, SlidingBalance, changes
from squealpipe.structures.spectrum import Solver, Spectrum
from squealpipe.structures.subspace import projected, subspace


@dataclass
class ConfirmedWay(Way):
    """Modes of a large structure at the frictions asked for, numbered and followed in a subspace.

    Attributes:
        path: frictions at which the subspace is followed, ascending.
        within: the way in the subspace; None before :meth:`follow`, or if there is none.
        basis: of the subspace, (n, m).
    """

    path: Sequence[float] = ()
    within: Way | None = None
    basis: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    _number_within: dict[int, int] = field(default_factory=dict)
    _confirmed: dict[float, float | None] = field(default_factory=dict)

    def follow(self, frictions: list[float], after: Way | None) -> None:
        """Number the modes at these frictions, ascending; the first as those of another way."""
        spectra: dict[float, Spectrum] = {}
        for mu in frictions:
            try:
                spectra[mu] = self._within_limits(self.solver.at(mu))
            except NoSlidingError as error:
                self.reasons.append(str(error))
        if not spectra:
            return
        self._follow_within(list(spectra.values()))
        for mu, spectrum in spectra.items():
            self._number(mu, spectrum, after)

    def _within_limits(self, spectrum: Spectrum) -> Spectrum:
        """Return the modes asked for, of all that dense algebra has."""
        chosen = self.solver.selected(spectrum)
        pairs = [
            pair for pair, is_in in zip(spectrum.pairs, chosen, strict=True) if is_in
        ]
        return replace(spectrum, pairs=pairs)

    def _follow_within(self, spectra: list[Spectrum]) -> None:
        whole = self.solver.structure
        most = max(len(each.pairs) for each in spectra)
        # ten modes at rest beyond twice as many as the whole has within its limits
        number = min(2 * most + 10, whole.size - 1)
        # more frictions would only add vectors to the subspace that it has nearly
        # the subspace has the modes of the whole at four of the frictions at most
        chosen = np.unique(np.linspace(0, len(spectra) - 1, 4).round().astype(int))
        basis = subspace(whole, [spectra[each] for each in chosen], number)
        # hundreds of contacts: what is stiffest is left out, and the whole has the last word anyway
        self.basis = basis[:, :DENSE]
        small = projected(whole, self.solver.modal, self.basis)
        outer = self.solver
        solver = Solver(small, outer.limits, outer.belt_speed, outer.varied)
        self.within = Way(solver)
        path = sorted({*self.path, *(each.mu for each in spectra)})
        self.within.follow(path, None)

    def _number(self, mu: float, spectrum: Spectrum, after: Way | None) -> None:
        """Numbers at one friction by those of the subspace."""
        place_of = self._places(mu, spectrum)
        size = len(spectrum.pairs)
        if not self.steps:
            numbers = self._first_numbers(spectrum, after)
        elif not place_of:  # nothing slides in the subspace
            last = list(self.steps.values())[-1]
            places, _ = successors(last.spectrum, spectrum)
            numbers = self._carried(last.numbers, places, size)
        else:
            at = [
                place for place in place_of if self._outer(place_of[place]) is not None
            ]
            outer = [self._outer(place_of[place]) for place in at]
            numbers = self._carried(np.array(outer, int), np.array(at, int), size)
        for place, inner_number in place_of.items():
            self._number_within.setdefault(int(numbers[place]), inner_number)
        self.steps[mu] = Step(spectrum, numbers)

    def _places(self, mu: float, spectrum: Spectrum) -> dict[int, int]:
        """Return the number in the subspace of each mode of the whole."""
        step = None if self.within is None else self.within.steps.get(mu)
        if step is None or not spectrum.pairs:
            return {}
        # beyond the highest mode of the whole the subspace may have others
        near = step.spectrum.values.imag <= 1.2 * spectrum.values.imag.max()
        pairs = [
            pair._replace(
                right=unit_vector(self.basis @ pair.right),
                left=unit_vector(self.basis @ pair.left),
            )
            for pair, is_near in zip(step.spectrum.pairs, near, strict=True)
            if is_near
        ]
        lifted = Spectrum(mu, spectrum.state, spectrum.pencil, pairs)
        places, _ = successors(lifted, spectrum)
        inner = step.numbers[near]
        return {
            int(place): int(number)
            for place, number in zip(places, inner, strict=True)
            if place >= 0
        }

    def critical(self, number: int) -> Critical:
        """Return the friction at which growth of one mode leaves zero, in the whole structure."""
        inner = self._number_within.get(number)
        lost = Critical(np.nan, Onset.not_followed)
        if self.within is None or inner is None:
            return lost
        found = self.within.critical(inner)
        grown = [
            mu
            for mu, step in self.steps.items()
            if step.pair(number) is not None and self.grown(step, number) is not None
        ]
        if found.onset == Onset.stable:
            return lost if grown else found
        if found.onset == Onset.unstable_throughout:
            return found if self._grows_from_the_start(inner) else lost
        if found.crossing is None:
            return lost
        mu = self._located(found.crossing)
        if mu is None or any(each < mu for each in grown):
            return lost
        return Critical(mu, Onset.located, self._outer(found.partner))

    def _outer(self, inner: int | None) -> int | None:
        """The number of a mode of the subspace in the whole."""
        known = {each: number for number, each in self._number_within.items()}
        return None if inner is None else known.get(inner)

    def _located(self, crossing: Crossing) -> float | None:
        """The friction at which the whole turns unstable as the subspace does; None if not."""
        # two that merge have one friction, which their searches may give with another last digit
        for known, mu in self._confirmed.items():
            if abs(
                known - crossing.mu
            ) <= 10 * SlidingBalance.located and self._is_merging(crossing):
                return mu
        if crossing.known is None:
            mu = self._located_at_change(crossing)
        else:
            mu = confirmed(self.solver.pencil, crossing, self.basis)
        if self._is_merging(crossing):
            self._confirmed[crossing.mu] = mu
        return mu

    def _is_merging(self, crossing: Crossing) -> bool:
        known = crossing.known
        return known is not None and isinstance(getattr(known, "roots", None), list)

    def _located_at_change(self, crossing: Crossing) -> float | None:
        """Return the friction at which a contact opens or closes, and with it the mode turns
        unstable.
        """
        solver = self.solver
        # friction within which a contact opens or closes in the whole where it does in the
        # subspace
        around = 1e-8
        low = max(crossing.low - around, 0.0)
        high = crossing.high + around
        try:
            passed = changes(solver.sliding, low, high)
        except NoSlidingError:
            return None
        if len(passed) != 1:
            return None
        before, after = (solver.pencil(mu) for mu in passed[0])
        is_stable = grows(before, crossing.before, self.basis) is False
        if is_stable and grows(after, crossing.after, self.basis):
            return passed[0][1]
        return None

    def _grows_from_the_start(self, inner: int) -> bool:
        """Return whether a mode grows in the whole at the first friction at which the subspace has
        it.
        """
        assert self.within is not None  # noqa: S101 (its modes are asked for)
        for mu, step in self.within.steps.items():
            if (pair := step.pair(inner)) is not None:
                pair = self.within.grown(step, inner) or pair
                return bool(grows(self.solver.pencil(mu), pair, self.basis))
        return False
