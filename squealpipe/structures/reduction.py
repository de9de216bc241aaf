"""Reduce a structure to the coordinates in which its unstable complex modes are cheapest to run.

Idea: for each number of coordinates the small dense structure is compared with the whole: the same
modes have to grow, at the same rate and frequency within a tolerance, and contacts that can stick
together have to be able to. Three sets are tried, modes at rest alone, with static responses of the
normal contact forces, and with those of all contact forces (:mod:`.coordinates`). Responses have
high frequencies, so the cost of a run decides: steps grow with the highest frequency, products with
the square of the number. Convergence is not monotonic, so the next larger numbers have to do as
well. Cost: the modes of the whole, and a small eigenvalue problem for each set that is tried.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la

from squealpipe.inputs import takes_units
from squealpipe.structures.agreement import Agreement, Truth, compared, refined, summary
from squealpipe.structures.contact import dependent_contacts
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.definition import ContactStructure, ReducedFrom
from squealpipe.structures.modes import modes_at_rest
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.sliding import NoSlidingError
from squealpipe.structures.spectrum import Limits, Solver, check_frequency
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.values import brief, is_finite_number, is_whole_number
from squealpipe.systems.one_thread import one_thread
from squealpipe.systems.progress import report, stage, stop_is_asked


@dataclass(frozen=True)
class ReductionSearch:
    """Rules of the search for the fewest modes that suffice."""

    and_larger: int = 3
    """Larger numbers of modes that must do as well: convergence is not monotonic."""
    first_modes: int = 64
    """Modes computed at first of a large structure, if it has no more contacts; up to here every
    number is tried."""


def band_needed(structure: ContactStructure, n_modes: int | None) -> str:
    """Ask for the band of a structure that is too large for all its modes, in words.

    Args:
        n_modes: number of modes to be kept, if one was asked for.
    """
    asked = "frequency_max (Hz) is needed, up to which unstable modes count"
    if n_modes is None:
        return f"{asked}, like 10 kHz; all are computed up to {DENSE}"
    highest = float(modes_at_rest(structure, n_modes)[0][-1] / (2.0 * np.pi))
    # modes up to a frequency describe those up to half of it well
    half = float(f"{0.5 * highest:.1e}")
    return (
        f"beside n_modes = {n_modes}, whose highest is at {engineering(highest, 'Hz')}, {asked}, "
        f"for instance frequency_max = {half:g}"
    )


@takes_units
@one_thread()
def reduce(
    structure: ContactStructure,
    *,
    n_modes: int | None = None,
    frequency_max: float | None = None,
    tol: float = 1e-2,
) -> ContactStructure:
    """The structure in coordinates of its lowest modes at rest and static responses at contacts.

    The modes are those of (M, K + Σ kᵢ nᵢnᵢᵀ) without friction. Static responses of normal contact
    forces, or of all, are kept beside them where this makes a run cheaper (attachment modes, which
    are no natural modes; :mod:`squealpipe.structures.coordinates`). All together are Φ, with ΦᵀMΦ =
    1 and a diagonal stiffness at rest; modal damping is a ratio of each one's own frequency. Their
    number is the smallest (beyond 64 at most an eighth above it), and no smaller than that of
    contacts without a tangential stiffness, for which the same modes grow as in the whole structure
    and every unstable one is right within ``tol``, by frequency and by growth rate, with this and
    the next three numbers, at the structure's ``mu`` and ``belt_speed``. Contacts whose sliding
    directions are independent stay so; those with a tangential stiffness need not.

    Args:
        n_modes: keep so many instead: modes at rest alone, unless the same modes grow only with
            static responses in place of the highest.
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        tol: of |Δω|/ω, and of |Δσ|/max(|σ|, 0.01 ω).

    Returns:
        A structure with ``modes`` (n, m), amplitudes → displacements, and ``record``: ``n_modes``,
        ``static_responses`` (how many of them are), ``frequency_error``, ``growth_rate_error``,
        ``unstable`` (how many modes were judged),
        ``missing`` (frequency and growth rate of unstable modes of the whole that it lacks) and
        ``agrees`` (whether the same modes grow).

    Raises:
        ValueError: an argument; there is no steady sliding.
        RuntimeError: all modes are not enough.
    """
    if not is_finite_number(tol) or not 0 < tol < 1:
        raise ValueError(f"tol = {brief(tol)}: a number between 0 and 1 is needed")
    fewest = fewest_modes(structure)
    if n_modes is not None and not (
        is_whole_number(n_modes) and fewest <= n_modes <= structure.size
    ):
        raise ValueError(
            f"n_modes = {brief(n_modes)}: a whole number from {fewest} (one for each contact "
            f"without a tangential_stiffness, two at least) to {structure.size} is needed"
        )
    check_frequency(frequency_max)
    if structure.size > DENSE and frequency_max is None:
        raise ValueError(
            f"{structure.size} degrees of freedom: {band_needed(structure, n_modes)}"
        )
    search = Search(structure, Truth.of(structure, frequency_max), frequency_max)
    if n_modes is not None:
        return search.structure(int(n_modes))
    found = search.smallest(fewest, tol)
    if found is None:
        raise RuntimeError(
            f"all {structure.size} modes miss tol = {tol:g}: an unstable mode is next to a double "
            "eigenvalue, whose growth rate has no more digits; raise tol or change mu a little"
        )
    return search.structure(*found)


def fewest_modes(structure: ContactStructure) -> int:
    """Return the fewest modes: one for each contact that sticks rigidly, and two for any.

    A contact's two directions cannot differ in a single coordinate.
    """
    rigid = sum(each.tangential_stiffness is None for each in structure.contacts)
    return min(max(rigid, 2 if structure.contacts else 1), structure.size)


class Search:
    """Search for coordinates by the unstable modes of the whole structure.

    Args:
        frequency_max: the end of the band, Hz, or None.
    """

    def __init__(
        self, structure: ContactStructure, truth: Truth, frequency_max: float | None
    ) -> None:
        self.whole, self.truth, self.frequency_max = structure, truth, frequency_max
        rules = ReductionSearch
        first = max(rules.first_modes, fewest_modes(structure) + rules.and_larger)
        self.space = StaticSpace(structure, min(first, structure.size))
        self._agreements: dict[tuple[int, int], Agreement | None] = {}

    def smallest(
        self, fewest: int, tol: float = 1e-2, most: int | None = None
    ) -> tuple[int, int] | None:
        """Return the coordinates that meet the tolerance, as do the next three numbers.

        Of those with and without static responses they are the cheapest to run, by the square of
        their number times the highest frequency.

        Args:
            most: numbers up to there are tried; None: all.

        Returns:
            Their number and the directions of static responses; None if none do.
        """
        number, most = fewest, self.whole.size if most is None else most
        best, lowest_cost = None, np.inf
        while number <= most:
            if stop_is_asked():  # there is nothing yet that could be kept
                raise KeyboardInterrupt
            # no other coordinates have a lower highest frequency
            if self._cost(number, 0) >= lowest_cost:
                break
            for directions in range(1 if number == self.whole.size else 3):
                cost = self._cost(number, directions)
                if cost < lowest_cost and self._meets_with_larger(
                    number, directions, tol
                ):
                    best, lowest_cost = (number, directions), cost
            report(lambda number=number, most=most: number / most)  # type: ignore[misc]
            # beyond, by an eighth at a time: trying every number takes minutes
            number += (
                1
                if number < ReductionSearch.first_modes
                else max(1, min(number // 8, most - number))
            )
        return best

    def _cost(self, number: int, directions: int) -> float:
        """Return the cost of a run: steps by the highest frequency, products by the number."""
        return float(number**2 * self._coordinates(number, directions).omega[-1])

    def _meets_with_larger(self, number: int, directions: int, tol: float) -> bool:
        largest = min(number + ReductionSearch.and_larger, self.whole.size)
        for each in range(number, largest + 1):
            agreement = self._agreement(each, directions)
            if agreement is None or not agreement.holds:
                return False
            if max(agreement.errors) > tol:
                return False
        return True

    def _agreement(self, number: int, directions: int) -> Agreement | None:
        """Return how coordinates agree with the whole; None if they cannot be taken."""
        if (number, directions) not in self._agreements:
            found = self._compared(self._coordinates(number, directions))
            self._agreements[number, directions] = found
        return self._agreements[number, directions]

    def _compared(self, coordinates: Coordinates) -> Agreement | None:
        if not self._reaches(coordinates):
            return None
        if coordinates.parallel_contact() or self._loses_stick(coordinates):
            return None
        try:
            values = quick_values(*coordinates.small_motions())
        except NoSlidingError:  # in these coordinates, not in the whole
            return None
        # growth below this share of the eigenvalue's modulus is round-off
        grows = values.real > 1e-9 * np.abs(values)
        return compared(self.truth, values, grows)

    def _reaches(self, coordinates: Coordinates) -> bool:
        """Tell whether coordinates reach half the highest unstable frequency of the whole."""
        if coordinates.number == self.whole.size:
            return True
        highest = np.abs(self.truth.unstable.imag).max(initial=0.0)
        return bool(coordinates.omega[-1] >= 0.5 * highest)

    def _loses_stick(self, coordinates: Coordinates) -> bool:
        """Tell whether directions of sliding, independent in the whole, are dependent here."""
        return self._all_can_stick and bool(coordinates.dependent())

    @cached_property
    def _all_can_stick(self) -> bool:
        return not dependent_of(self.whole)

    def _coordinates(self, number: int, directions: int) -> Coordinates:
        if number > self.space.n_modes:
            larger = max(number + ReductionSearch.and_larger, 2 * self.space.n_modes)
            self.space = StaticSpace(self.whole, min(larger, self.whole.size))
        return Coordinates(self.space, number, directions)

    def _chosen(self, number: int) -> Coordinates:
        """Return so many coordinates: the first in which the same modes grow as in the whole.

        Modes at rest alone come first, then those with normal and with all static responses.

        Raises:
            ValueError: a contact has no two directions in any; says how many suffice.
        """
        usable = []
        for directions in range(3):
            coordinates = self._coordinates(number, directions)
            agreement = self._agreement(number, directions)
            if agreement is not None and agreement.holds:
                return coordinates
            if not coordinates.parallel_contact():
                usable.append(coordinates)
        if usable:
            return usable[0]
        name = coordinates.parallel_contact()
        enough = next(
            each
            for each in range(number, self.whole.size + 1)
            if not self._coordinates(each, 0).parallel_contact()
        )
        raise ValueError(
            f"n_modes = {number}: contact {name} has no two directions in the {number} modes "
            f"kept; keep more (n_modes={enough} suffices)"
        )

    def structure(self, number: int, directions: int | None = None) -> ContactStructure:
        """Return the structure in so many coordinates with its record.

        Args:
            directions: of static responses; None: the first in which the same modes grow.

        Raises:
            ValueError: a contact has no two directions in these modes; says how many suffice.
        """
        coordinates = (
            self._chosen(number)
            if directions is None
            else self._coordinates(number, directions)
        )
        reduced = coordinates.reduced
        reduced.modes = coordinates.modes
        # modes of a reduced structure lead to its amplitudes, which no mesh shows
        reduced.mesh = self.whole.mesh if self.whole.modes is None else None
        reduced.reduced_from = ReducedFrom(
            self.whole, self.frequency_max, self.truth, coordinates.directions
        )
        spectrum = Solver(reduced, Limits(), reduced.belt_speed).at(reduced.mu)
        agreement = agreement_of(self.truth, spectrum, reduced.modes)
        reduced.record = {
            "n_modes": number,
            "static_responses": number - coordinates.n_modes,
            **summary(agreement),
            "unstable": len(self.truth.unstable),
        }
        return reduced


def reduced_again(
    structure: ContactStructure,
    number: int,
    static_responses: int,
    frequency_max: float | None,
) -> ContactStructure:
    """Return a structure in the coordinates of a record.

    Args:
        number, static_responses: as in the record.
        frequency_max: end of the band, Hz, or None.
    """
    search = Search(structure, Truth.of(structure, frequency_max), frequency_max)
    found = (search.structure(number, directions) for directions in range(3))
    return next(
        each for each in found if each.record["static_responses"] == static_responses
    )


def quick_values(stiffness: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Return the s with Im s ≥ 0 of s² + C s + K, without vectors, to round-off of the largest."""
    if not damping.any():
        roots = 1j * np.sqrt(la.eigvals(stiffness).astype(complex))
        values = np.concatenate([roots, -roots])
    else:
        size = len(stiffness)
        unit = np.sqrt(np.linalg.norm(stiffness)) or np.linalg.norm(damping)
        first_order = np.zeros((2 * size, 2 * size))
        first_order[:size, size:] = unit * np.eye(size)
        first_order[size:, :size] = -stiffness / unit
        first_order[size:, size:] = -damping
        values = la.eigvals(first_order)
    return np.asarray(values[values.imag >= 0])


def dependent_of(structure: ContactStructure) -> list[str]:
    """Name the contacts of a structure that cannot all stick at once."""
    return dependent_contacts(structure.contacts, structure.tangentials)


def agreement_of(truth: Truth, spectrum: Any, modes: np.ndarray) -> Agreement:
    """Return how the modes of a reduced structure agree with those of the whole.

    Args:
        spectrum: of the reduced structure.
        modes: (n of the whole, n), amplitudes → displacements.
    """
    grows = spectrum.values.real > spectrum.growth_errors
    refine = refined(truth, spectrum, modes)
    return compared(truth, spectrum.values, grows, refine, truth.undamped)


def modes_that_would_do(
    structure: ContactStructure, truth: Truth, most: int
) -> int | None:
    """Return a larger number of modes that agrees with the whole within 1 %, None if none does.

    Args:
        most: number of modes that may be kept.
    """
    origin = structure.reduced_from
    if origin is None:
        return None
    search = Search(origin.whole, truth, origin.frequency_max)
    most = min(most, origin.whole.size)
    found = search.smallest(structure.size + 1, most=most)
    return None if found is None else found[0]


def fitted(
    structure: ContactStructure, frequency_max: float | None, most: int
) -> ContactStructure:
    """Reduce to the fewest modes that agree within 1 %, or to ``most`` where none do.

    Args:
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        most: number of modes that may be kept, no smaller than that of contacts.
    """
    if structure.size > DENSE and frequency_max is None:
        return reduce(structure)  # raises: a band is needed
    with stage(f"modes of the whole structure of {structure.size} degrees of freedom"):
        truth = Truth.of(structure, frequency_max)
    search = Search(structure, truth, frequency_max)
    with stage("the fewest modes that agree with the whole"):
        found = search.smallest(fewest_modes(structure), most=most)
    return search.structure(*(found or (most,)))
