"""A structure of no more modes than its unstable complex modes need."""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.inputs import takes_units
from squealpipe.methods.progress import report
from squealpipe.parameters import brief, is_finite_number, is_whole_number
from squealpipe.systems.structures.contact import Contact
from squealpipe.systems.structures.definition import ContactStructure
from squealpipe.systems.structures.dense import all_modes
from squealpipe.systems.structures.linearized import pencil_about
from squealpipe.systems.structures.modes import modes_at_rest
from squealpipe.systems.structures.pencil import DENSE
from squealpipe.systems.structures.sliding import steady_sliding
from squealpipe.systems.structures.spectrum import Limits, Solver, check_frequency

AND_LARGER = 3
"""Larger numbers of modes that must do as well: convergence is not monotonic."""
FIRST = 64
"""Modes computed at first of a large structure."""
SMALLEST_GROWTH = 0.01
"""Growth below this share of the frequency is judged by the frequency."""


class Errors(NamedTuple):
    """The largest errors over all unstable modes.

    Attributes:
        frequency: |Δω|/ω.
        growth: |Δσ|/max(|σ|, 0.01 ω).
    """

    frequency: float
    growth: float


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
    the smallest, and no smaller than that of contacts, for which every unstable mode at the
    structure's ``mu`` and ``belt_speed`` is right within ``tol``, by frequency and by growth rate,
    with this and the next three numbers.

    Args:
        n_modes: keep so many instead.
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        tol: of |Δω|/ω, and of |Δσ|/max(|σ|, 0.01 ω).

    Returns:
        A structure with ``modes`` (n, m), amplitudes → displacements, and ``record``: ``n_modes``,
        ``frequency_error``, ``growth_rate_error`` and ``unstable``, how many modes were judged.

    Raises:
        ValueError: an argument; there is no steady sliding.
        RuntimeError: all modes are not enough.
    """
    if not is_finite_number(tol) or not 0 < tol < 1:
        raise ValueError(f"tol = {brief(tol)}: a number between 0 and 1 is needed")
    # a contact's two directions are apart in two coordinates at least
    fewest = max(len(structure.contacts), 2 if structure.contacts else 1)
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
            f"{structure.size} degrees of freedom: give frequency_max (Hz), up to which unstable "
            f"modes are to be kept; all are computed up to {DENSE}"
        )
    truth = _unstable(structure, frequency_max)
    if n_modes is not None:
        kept = Kept(structure, int(n_modes))
        return kept.structure(
            int(n_modes), _errors(truth, kept.values(int(n_modes))), truth
        )
    return _smallest(structure, truth, fewest, tol)


def _smallest(
    structure: ContactStructure, truth: np.ndarray, fewest: int, tol: float
) -> ContactStructure:
    most = structure.size
    kept = Kept(structure, min(max(FIRST, fewest + AND_LARGER), most))
    met: list[tuple[int, Errors]] = []
    for number in range(fewest, most + 1):
        if number > kept.number:
            kept = Kept(structure, min(2 * kept.number, most))
        errors = _errors(truth, kept.values(number))
        met = [*met, (number, errors)] if max(errors) <= tol else []
        report(lambda number=number: number / most)  # type: ignore[misc]
        if len(met) > AND_LARGER or (met and number == most):
            return kept.structure(*met[0], truth)
    raise RuntimeError(
        f"all {most} modes miss tol = {tol:g}: an unstable mode is next to a double eigenvalue, "
        "whose growth rate has no more digits; raise tol or change mu a little"
    )


class Kept:
    """The lowest modes, and what becomes of matrices and contacts in their coordinates."""

    def __init__(self, structure: ContactStructure, number: int) -> None:
        self.whole, self.number = structure, number
        self.omega, self.modes = modes_at_rest(structure, number)
        modes = self.modes
        at_rest = modes.T @ (structure.stiffness_at_rest @ modes)
        # round-off of the modes would couple them
        self.stiffness = modes.T @ (structure.stiffness @ modes)
        self.stiffness += np.diag(self.omega**2) - at_rest
        self.damping = modes.T @ (structure.damping @ modes)
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
        self.load = modes.T @ structure.load
        self.balanced = structure.given_load is None

    def reduced(self, number: int) -> ContactStructure:
        """The structure of the lowest of these modes."""
        contacts = [
            Contact(
                each.name,
                self.normals[:number, place],
                self.tangentials[:number, place],
                each.stiffness,
                each.preload,
                each.speed,
            )
            for place, each in enumerate(self.whole.contacts)
        ]
        return type(self.whole)(
            **{
                **self.whole.arguments,
                "mass": np.eye(number),
                "stiffness": self.stiffness[:number, :number],
                "damping": self.damping[:number, :number],
                "modal_damping": 0.0,
                "contacts": contacts,
                "load": None if self.balanced else self.load[:number],
            }
        )

    def values(self, number: int) -> np.ndarray:
        """Eigenvalues of the structure of so many modes about its own steady sliding."""
        reduced = self.reduced(number)
        state = steady_sliding(reduced, reduced.mu, reduced.belt_speed)
        pairs = all_modes(pencil_about(reduced, state, None))
        return np.array([each.value for each in pairs])

    def structure(
        self, number: int, errors: Errors, truth: np.ndarray
    ) -> ContactStructure:
        """That structure with its modes and its record."""
        reduced = self.reduced(number)
        reduced.modes = self.modes[:, :number]
        reduced.record = {
            "n_modes": number,
            "frequency_error": errors.frequency,
            "growth_rate_error": errors.growth,
            "unstable": len(truth),
        }
        return reduced


def _unstable(structure: ContactStructure, frequency_max: float | None) -> Any:
    """Eigenvalues of the unstable modes of the whole structure."""
    solver = Solver(structure, Limits(frequency_max), structure.belt_speed)
    spectrum = solver.at(structure.mu)
    grows = spectrum.values.real > spectrum.growth_errors
    return spectrum.values[grows & solver.selected(spectrum)]


def _errors(truth: np.ndarray, reduced: np.ndarray) -> Errors:
    """Of each unstable mode against the nearest of the reduced structure, the largest."""
    frequency = growth = 0.0
    for value in truth:
        nearest = reduced[np.abs(reduced - value).argmin()]
        size = abs(value.imag) or abs(value)
        frequency = max(frequency, abs(nearest.imag - value.imag) / size)
        scale = max(abs(value.real), SMALLEST_GROWTH * size)
        growth = max(growth, abs(nearest.real - value.real) / scale)
    return Errors(float(frequency), float(growth))
