"""Reduce a structure to the fewest modes that its unstable complex modes need.

Idea: the lowest modes at rest are computed once, and for each number of them the small dense
structure is compared with the whole: the same modes have to grow, at the same rate and frequency
within a tolerance, and contacts that can stick together have to be able to in these modes.
Convergence is not monotonic, so the next larger numbers have to do as well. Invariant: the mass
matrix in modal coordinates is 1. Cost: the modes of the whole, and a small eigenvalue problem for
each number that is tried.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la

from squealpipe.inputs import takes_units
from squealpipe.structures.agreement import Agreement, Truth, compared, refined, summary
from squealpipe.structures.contact import are_parallel, dependent_contacts
from squealpipe.structures.definition import ContactStructure, ReducedFrom
from squealpipe.structures.dense import all_modes
from squealpipe.structures.linearized import pencil_about
from squealpipe.structures.modes import modes_at_rest
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.sliding import (
    NoSlidingError,
    acting_directions,
    contact_stiffness,
    steady_sliding,
)
from squealpipe.structures.spectrum import Limits, Solver, check_frequency
from squealpipe.structures.subspace import in_coordinates
from squealpipe.systems.inputs.values import brief, is_finite_number, is_whole_number
from squealpipe.systems.one_thread import one_thread
from squealpipe.systems.progress import report, stage, stop_is_asked
from squealpipe.units import engineering


@dataclass(frozen=True)
class ReductionSearch:
    """Rules of the search for the fewest modes that suffice."""

    and_larger: int = 3
    """Larger numbers of modes that must do as well: convergence is not monotonic."""
    first_modes: int = 64
    """Modes computed at first of a large structure; up to here every number is tried."""


REDUCTION_SEARCH = ReductionSearch()


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
def reduce(
    structure: ContactStructure,
    *,
    n_modes: int | None = None,
    frequency_max: float | None = None,
    tol: float = 1e-2,
) -> ContactStructure:
    """The structure in coordinates of its lowest modes at rest.

    The modes Φ are those of (M, K + Σ kᵢ nᵢnᵢᵀ) without friction, with ΦᵀMΦ = 1. Their number is
    the smallest (beyond 64 at most an eighth above it), and no smaller than that of contacts, for
    which the same modes grow as in the whole structure and every unstable one is right within
    ``tol``, by frequency and by growth rate, with this and the next three numbers, at the
    structure's ``mu`` and ``belt_speed``. Contacts whose sliding directions are independent stay
    so.

    Args:
        n_modes: keep so many instead.
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        tol: of |Δω|/ω, and of |Δσ|/max(|σ|, 0.01 ω).

    Returns:
        A structure with ``modes`` (n, m), amplitudes → displacements, and ``record``: ``n_modes``,
        ``frequency_error``, ``growth_rate_error``, ``unstable`` (how many modes were judged),
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
            f"n_modes = {brief(n_modes)}: a whole number from {fewest} (one for each contact, two "
            f"at least) to {structure.size} is needed"
        )
    check_frequency(frequency_max)
    if structure.size > DENSE and frequency_max is None:
        raise ValueError(
            f"{structure.size} degrees of freedom: {band_needed(structure, n_modes)}"
        )
    search = Search(structure, Truth.of(structure, frequency_max), frequency_max)
    if n_modes is not None:
        return search.structure(int(n_modes))
    number = search.smallest(fewest, tol)
    if number is None:
        raise RuntimeError(
            f"all {structure.size} modes miss tol = {tol:g}: an unstable mode is next to a double "
            "eigenvalue, whose growth rate has no more digits; raise tol or change mu a little"
        )
    return search.structure(number)


def fewest_modes(structure: ContactStructure) -> int:
    """Return the fewest modes: one for each contact, and two where there are any.

    A contact's two directions cannot differ in a single coordinate.
    """
    return min(
        max(len(structure.contacts), 2 if structure.contacts else 1), structure.size
    )


class Kept:
    """The lowest modes, and what becomes of matrices and contacts in their coordinates."""

    def __init__(self, structure: ContactStructure, number: int) -> None:
        self.whole, self.number = structure, number
        self.omega, self.modes = modes_at_rest(structure, number)
        modes = self.modes
        at_rest = modes.T @ (structure.stiffness_at_rest @ modes)
        # round-off of the modes would couple them
        self.stiffness = modes.T @ (structure.given_stiffness @ modes)
        self.stiffness += np.diag(self.omega**2) - at_rest
        self.damping = modes.T @ (structure.given_damping @ modes)
        self.speed_terms = structure.speed_terms.mapped(
            lambda each: modes.T @ (each @ modes)
        )
        ratios = np.zeros(number)
        asked = (
            np.broadcast_to(structure.modal_damping, number)
            if (structure.modal_damping.ndim == 0)
            else structure.modal_damping[:number]
        )
        ratios[: len(asked)] = asked
        self.damping += np.diag(2.0 * ratios * self.omega)
        self.normals = modes.T @ structure.normals
        self.tangentials = modes.T @ structure.tangentials
        self.transversals = modes.T @ structure.transversals
        self.load = modes.T @ structure.load
        self.balanced = structure.given_load is None

    def parallel_contact(self, number: int) -> str | None:
        """Name the first contact whose two directions are one in the lowest of these modes."""
        for index, contact in enumerate(self.whole.contacts):
            normal, along = (
                self.normals[:number, index],
                self.tangentials[:number, index],
            )
            if not normal.any() or not along.any() or are_parallel(normal, along):
                return contact.name
        return None

    def dependent(self, number: int) -> list[str]:
        """Name the contacts whose sliding directions are dependent in the lowest of these modes."""
        names = [contact.name for contact in self.whole.contacts]
        return dependent_contacts(names, self.tangentials[:number])

    def reduced(self, number: int) -> ContactStructure:
        """The structure of the lowest of these modes."""
        return in_coordinates(
            self.whole,
            self.stiffness[:number, :number],
            self.damping[:number, :number],
            (
                self.normals[:number],
                self.tangentials[:number],
                self.transversals[:number],
            ),
            None if self.balanced else self.load[:number],
            self.speed_terms.mapped(lambda each: each[:number, :number]),
        )

    def values(self, number: int) -> np.ndarray:
        """Eigenvalues of the structure of so many modes about its own steady sliding."""
        reduced = self.reduced(number)
        state = steady_sliding(reduced, reduced.mu, reduced.belt_speed)
        pairs = all_modes(pencil_about(reduced, state, None))
        return np.array([pair.value for pair in pairs])

    def small_motions(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Return stiffness and damping about steady sliding, (number, number); the mass is 1.

        Raises:
            NoSlidingError: there is no steady sliding in so many modes.
        """
        reduced = self.reduced(number)
        state = steady_sliding(reduced, reduced.mu, reduced.belt_speed)
        acting = acting_directions(reduced, state.closed, state.drag)
        springs = contact_stiffness(reduced, state.closed, acting)
        stiffness = (reduced.stiffness + springs).toarray()
        along = self.tangentials[:number]
        damping = (
            reduced.damping.toarray() + along * (state.force * state.slope) @ along.T
        )
        return stiffness, damping


class Search:
    """Search for a number of modes by the unstable modes of the whole structure.

    Args:
        frequency_max: the end of the band, Hz, or None.
    """

    def __init__(
        self, structure: ContactStructure, truth: Truth, frequency_max: float | None
    ) -> None:
        self.whole, self.truth, self.frequency_max = structure, truth, frequency_max
        self.kept = Kept(structure, min(REDUCTION_SEARCH.first_modes, structure.size))

    def smallest(
        self, fewest: int, tol: float = 1e-2, most: int | None = None
    ) -> int | None:
        """Return the smallest number that meets the tolerance, as do the next three; None if none.

        Args:
            most: numbers up to there are tried; None: all.
        """
        number, most = fewest, self.whole.size if most is None else most
        while number <= most:
            if stop_is_asked():  # there is nothing yet that could be kept
                raise KeyboardInterrupt
            with one_thread():  # with small matrices threads cost more than they save
                meets = self._meets_with_larger(number, tol)
            if meets:
                return number
            report(lambda number=number, most=most: number / most)  # type: ignore[misc]
            # beyond, by an eighth at a time: trying every number takes minutes
            number += (
                1
                if number < REDUCTION_SEARCH.first_modes
                else max(1, min(number // 8, most - number))
            )
        return None

    def _meets_with_larger(self, number: int, tol: float) -> bool:
        largest = min(number + REDUCTION_SEARCH.and_larger, self.whole.size)
        return all(self._meets(each, tol) for each in range(number, largest + 1))

    def _meets(self, number: int, tol: float) -> bool:
        kept = self._at_least(number)
        if not self._reaches(number):
            return False
        if kept.parallel_contact(number) or self._loses_stick(number):
            return False
        try:
            values = quick_values(*kept.small_motions(number))
        except NoSlidingError:  # in these modes, not in the whole
            return False
        # growth below this share of the eigenvalue's modulus is round-off
        grows = values.real > 1e-9 * np.abs(values)
        agreement = compared(self.truth, values, grows)
        return agreement.holds and max(agreement.errors) <= tol

    def _reaches(self, number: int) -> bool:
        """Tell whether the modes kept reach half the highest unstable frequency of the whole."""
        if number == self.whole.size:
            return True
        highest = np.abs(self.truth.unstable.imag).max(initial=0.0)
        return bool(self.kept.omega[number - 1] >= 0.5 * highest)

    def _loses_stick(self, number: int) -> bool:
        """Tell whether directions of sliding, independent in the whole, are dependent here."""
        return self._all_can_stick and bool(self._at_least(number).dependent(number))

    @cached_property
    def _all_can_stick(self) -> bool:
        return not dependent_of(self.whole)

    def _at_least(self, number: int) -> Kept:
        if number > self.kept.number:
            larger = max(number + REDUCTION_SEARCH.and_larger, 2 * self.kept.number)
            self.kept = Kept(self.whole, min(larger, self.whole.size))
        return self.kept

    def structure(self, number: int) -> ContactStructure:
        """Return the structure of so many modes with its record.

        Raises:
            ValueError: a contact has no two directions in these modes; says how many suffice.
        """
        kept = self._at_least(number)
        if name := kept.parallel_contact(number):
            enough = next(
                each
                for each in range(number, self.whole.size + 1)
                if not self._at_least(each).parallel_contact(each)
            )
            raise ValueError(
                f"n_modes = {number}: contact {name} has no two directions in the {number} modes "
                f"kept; keep more (n_modes={enough} suffices)"
            )
        reduced = kept.reduced(number)
        reduced.modes = kept.modes[:, :number]
        # modes of a reduced structure lead to its amplitudes, which no mesh shows
        reduced.mesh = self.whole.mesh if self.whole.modes is None else None
        reduced.reduced_from = ReducedFrom(self.whole, self.frequency_max, self.truth)
        spectrum = Solver(reduced, Limits(), reduced.belt_speed).at(reduced.mu)
        agreement = agreement_of(self.truth, spectrum, reduced.modes)
        reduced.record = {
            "n_modes": number,
            **summary(agreement),
            "unstable": len(self.truth.unstable),
        }
        return reduced


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
    names = [contact.name for contact in structure.contacts]
    return dependent_contacts(names, structure.tangentials)


def agreement_of(truth: Truth, spectrum: Any, modes: np.ndarray) -> Agreement:
    """Return how the modes of a reduced structure agree with those of the whole.

    Args:
        spectrum: of the reduced structure.
        modes: (n of the whole, n), amplitudes → displacements.
    """
    grows = spectrum.values.real > spectrum.growth_errors
    return compared(truth, spectrum.values, grows, refined(truth, spectrum, modes))


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
    return search.smallest(structure.size + 1, most=min(most, origin.whole.size))


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
        number = search.smallest(fewest_modes(structure), most=most)
    return search.structure(most if number is None else number)
