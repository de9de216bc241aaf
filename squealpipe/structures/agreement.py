"""Agreement of the modes of a reduced structure with those of the whole.

Each mode of the reduced structure is paired with one of the whole, so that the relative distances
of their eigenvalues have the smallest sum. An unstable mode of the whole whose partner does not
grow, or has another frequency, is missing in the reduced one; a growth rate that differs from its
partner's by more than its own size has no known sign. Where either occurs, runs of the reduced
structure say nothing about the whole.

Modal damping of a large structure is computed for its modes up to a frequency, and a reduced one
has damping beyond. What the modes beyond would change in a growth rate is bounded and counted as an
error of it: with a mode's part x beyond those damped, xᴴ C x is at most 2 ζ √(xᴴ K x · xᴴ M x).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from scipy.optimize import linear_sum_assignment

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.refinement import polished
from squealpipe.structures.spectrum import Limits, Solver, Spectrum


class Errors(NamedTuple):
    """The largest errors over the unstable modes of the whole.

    Attributes:
        frequency: |Δω|/ω.
        growth: |Δσ|/max(|σ|, 0.01 ω).
    """

    frequency: float
    growth: float


@dataclass(frozen=True)
class Truth:
    """Modes of the whole structure about its steady sliding.

    Attributes:
        values: eigenvalues, 1/s, those up to a tenth beyond the band; all of a dense structure.
        grows: which grow beyond their own error.
        limit: end of the band, rad/s; infinite without one.
        spectrum: the spectrum that holds them, whose pencil refines others.
        undamped: bounds of what damping of modes beyond those damped changes in each, 1/s.
    """

    values: np.ndarray
    grows: np.ndarray
    limit: float
    spectrum: Spectrum
    undamped: np.ndarray

    @classmethod
    def of(cls, whole: ContactStructure, frequency_max: float | None) -> Self:
        """Compute the modes at the structure's own friction and belt speed.

        Args:
            frequency_max: the end of the band, Hz; None: all of a dense structure.
        """
        # a mode just beyond the band may be the partner of one within it
        reach = None if frequency_max is None else 1.1 * frequency_max
        spectrum = Solver(whole, Limits(reach), whole.belt_speed).at(whole.mu)
        limit = np.inf if frequency_max is None else 2.0 * np.pi * frequency_max
        grows = spectrum.values.real > spectrum.growth_errors
        return cls(spectrum.values, grows, limit, spectrum, _undamped(whole, spectrum))

    @property
    def within(self) -> np.ndarray:
        """Mask of the modes within the band."""
        return np.asarray(self.values.imag <= self.limit)

    @property
    def decays(self) -> bool:
        """Tell whether every mode within the band decays by more than its error."""
        decaying = self.values.real < -self.spectrum.growth_errors
        return bool(decaying[self.within].all())

    @property
    def is_all(self) -> bool:
        """Tell whether these are all modes of the structure."""
        return self.spectrum.pencil.is_dense

    @property
    def unstable(self) -> np.ndarray:
        """Eigenvalues of the unstable modes within the band, the fastest first."""
        found = self.values[self.grows & self.within]
        order = np.argsort(-found.real, kind="stable")
        return np.asarray(found[order])


@dataclass(frozen=True)
class Agreement:
    """Errors of the modes of a reduced structure.

    Attributes:
        frequency_errors: of each mode's frequency, Hz; NaN where no partner is known.
        growth_errors: of each mode's growth rate, 1/s; NaN likewise.
        missing: unstable modes of the whole within the band that the reduced structure lacks, as
            eigenvalues, 1/s, the fastest first.
        unsure: places of modes that grow in the reduced structure by less than their error, or
            whose partner in the whole is not known.
        beyond: which of these are beyond the band, mask: they decide nothing about the band.
        errors: the largest relative ones, over the unstable modes of the whole.
        decays: whether every mode of the whole within the band decays.
    """

    frequency_errors: np.ndarray
    growth_errors: np.ndarray
    missing: np.ndarray
    unsure: np.ndarray
    beyond: np.ndarray
    errors: Errors
    decays: bool

    @property
    def holds(self) -> bool:
        """Tell whether the same modes grow in both structures, within the band."""
        return not self.missing.size and bool(self.beyond.all())


def exact(spectrum: Spectrum) -> Agreement:
    """Return the agreement of a structure that is not reduced with itself."""
    nothing = np.zeros(len(spectrum.values))
    decays = bool((spectrum.values.real < -spectrum.growth_errors).all())
    return Agreement(
        nothing,
        np.abs(spectrum.errors),
        np.empty(0, complex),
        np.empty(0, int),
        np.empty(0, bool),
        Errors(0.0, 0.0),
        decays,
    )


def compared(
    truth: Truth,
    values: np.ndarray,
    grows: np.ndarray,
    refine: Callable[[int], complex | None] | None = None,
    undamped: np.ndarray | None = None,
) -> Agreement:
    """Pair the modes of a reduced structure with those of the whole.

    Args:
        values: eigenvalues of the reduced structure, 1/s.
        grows: which of them grow.
        refine: from the place of a mode beyond the band to the eigenvalue of the whole that it
            stands for. Without it modes beyond the band of a large structure are not judged.
        undamped: further errors of the growth rates of the whole's modes, 1/s; None: none.
    """
    if undamped is None:
        undamped = np.zeros(len(truth.values))
    further = np.zeros(len(values))
    partners = np.full(len(values), np.nan, complex)
    stands_for = np.full(len(truth.values), -1)
    if len(values) and len(truth.values):
        reduced, whole = values[:, None], truth.values[None, :]
        sizes = np.abs(reduced) + np.abs(whole)
        away = np.abs(reduced - whole) / np.where(sizes > 0, sizes, 1.0)
        rows, columns = linear_sum_assignment(away)
        partners[rows] = truth.values[columns]
        stands_for[columns] = rows
        further[rows] = undamped[columns]
    judged = np.ones(len(values), bool)
    if not truth.is_all:  # beyond the band there was nothing to choose from
        partners[_far(partners, values)] = np.nan
        judged = values.imag <= truth.limit
        if refine is not None:
            judged[:] = True
            for place in np.flatnonzero(grows & np.isnan(partners)):
                found = refine(int(place))
                partners[place] = np.nan if found is None else found
    off = partners - values
    growth = np.abs(off.real) + further
    elsewhere = _far(partners, values)
    unsure = judged & grows & ~((growth < values.real) & ~elsewhere)
    missing, errors = [], Errors(0.0, 0.0)
    for column in np.flatnonzero(truth.grows & truth.within):
        value, place = truth.values[column], stands_for[column]
        if place < 0 or not grows[place] or elsewhere[place]:
            missing.append(value)
        size = abs(value.imag) or abs(value)
        nearest = (
            values[place] if place >= 0 else values[np.abs(values - value).argmin()]
        )
        # a tiny growth rate is judged by the frequency
        scale = max(abs(value.real), 0.01 * size)
        apart = abs(nearest.real - value.real) + undamped[column]
        errors = Errors(
            max(errors.frequency, float(abs(nearest.imag - value.imag) / size)),
            max(errors.growth, float(apart / scale)),
        )
    lost, places = np.array(missing, complex), np.flatnonzero(unsure)
    return Agreement(
        np.abs(off.imag) / (2.0 * np.pi),
        growth,
        lost[np.argsort(-lost.real, kind="stable")],
        places,
        values.imag[places] > truth.limit,
        errors,
        truth.decays,
    )


def _undamped(whole: ContactStructure, spectrum: Spectrum) -> np.ndarray:
    """Return how much modal damping of the modes beyond those damped changes each, at most, 1/s."""
    pencil, ratios = spectrum.pencil, whole.modal_damping
    modal = pencil.modal
    if pencil.is_dense or modal is None or ratios.ndim:
        return np.zeros(len(spectrum.values))
    ratio = float(ratios)
    omega = modal.weights / (2.0 * ratio)
    at_rest = whole.stiffness_at_rest

    def beyond(vector: np.ndarray) -> float:
        inside = np.abs(modal.columns.T @ vector) ** 2
        kinetic = (vector.conj() @ (pencil.mass @ vector)).real - inside.sum()
        elastic = (vector.conj() @ (at_rest @ vector)).real - omega**2 @ inside
        return float(2.0 * ratio * np.sqrt(max(kinetic, 0.0) * max(elastic, 0.0)))

    bounds = []
    for s, right, left, *_ in spectrum.pairs:
        slope = 2.0 * s * (pencil.mass @ right) + pencil.damping @ right
        slope = slope + modal.product(right)
        size = abs(left.conj() @ slope)
        bounds.append(abs(s) * np.sqrt(beyond(right) * beyond(left)) / size)
    return np.array(bounds)


def _far(partners: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Mask of pairs that are not one mode: frequencies a tenth apart, or no partner."""
    size = np.maximum(np.abs(values.imag), np.abs(partners.imag))
    size = np.where(size > 0, size, np.abs(values))
    with np.errstate(invalid="ignore"):
        return np.asarray(~(np.abs(partners.imag - values.imag) <= 0.1 * size))


def refined(
    truth: Truth, spectrum: Spectrum, modes: np.ndarray
) -> Callable[[int], complex | None]:
    """Return the function that refines a mode of the reduced structure to one of the whole.

    Args:
        spectrum: of the reduced structure.
        modes: (n of the whole, n), amplitudes → displacements.
    """

    def refine(place: int) -> complex | None:
        pair = spectrum.pairs[place]
        right, left = modes @ pair.right, modes @ pair.left
        try:
            return complex(
                polished(truth.spectrum.pencil, pair.value, right, left).value
            )
        except (
            RuntimeError
        ):  # factors are singular: it is at an eigenvalue of another mode
            return None

    return refine


def summary(agreement: Agreement) -> dict[str, Any]:
    """Return the part of a reduced structure's record that states its errors."""
    return {
        "frequency_error": agreement.errors.frequency,
        "growth_rate_error": agreement.errors.growth,
        "missing": [
            (float(each.imag / (2.0 * np.pi)), float(each.real))
            for each in agreement.missing
        ],
        "agrees": agreement.holds,
    }
