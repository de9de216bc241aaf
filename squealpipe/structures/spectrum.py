"""Solve for complex modes about one steady sliding, within limits of frequency or number.

Idea: up to a thousand degrees of freedom all eigenvalues are computed by dense algebra; of larger
structures those in a band of frequency, by shifts along it, until right and left eigenvectors about
other points have the same ones. Each eigenvalue has an error that covers rounding of the matrices
and of the solution, by which growth is told from none. Invariant: a spectrum that may lack a mode
raises and is not returned.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.structures import band, dense
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.linearized import pencil_about
from squealpipe.structures.modes import modal_damping_of, modes_at_rest
from squealpipe.structures.pencil import DENSE, LowRank, Pencil
from squealpipe.structures.refinement import (
    Eigenpair,
    growing_first,
    with_errors_of_forces,
)
from squealpipe.structures.sliding import SteadySliding, steady_sliding
from squealpipe.structures.stiff import beyond_gap, stiff_degrees
from squealpipe.structures.varied_friction import VariedFriction
from squealpipe.systems.inputs.values import brief, is_finite_number


@dataclass(frozen=True)
class Spectrum:
    """Modes about one state.

    Attributes:
        pencil: of small motions.
        pairs: its modes, by frequency.
    """

    mu: float
    state: SteadySliding
    pencil: Pencil
    pairs: list[Eigenpair]

    @cached_property
    def values(self) -> np.ndarray:
        """Eigenvalues s, (modes,)."""
        return np.array([pair.value for pair in self.pairs], complex)

    @cached_property
    def shapes(self) -> np.ndarray:
        """Right eigenvectors, (n, modes)."""
        size = self.pencil.size
        return np.array([pair.right for pair in self.pairs]).reshape(-1, size).T

    @cached_property
    def errors(self) -> np.ndarray:
        """Errors of the eigenvalues, rad/s."""
        return np.array([pair.error for pair in self.pairs])

    @property
    def growth_errors(self) -> np.ndarray:
        """Errors of the growth rates, 1/s: none of an undamped mode that does not grow."""
        still = (
            self.pencil.is_undamped & (self.values.real == 0) & (self.values.imag > 0)
        )
        return np.where(still, 0.0, self.errors)

    @property
    def outcomes(self) -> np.ndarray:
        """Outcome of each mode: converged, or rigid where the eigenvalue is 0 within its error.

        Nothing holds a rigid mode, or a rigid link of 1e20 has taken the digits from the matrix,
        which looks the same. Neither is called stable.
        """
        rigid = np.abs(self.values) <= self.errors
        return np.where(rigid, Outcome.rigid_mode, Outcome.converged)

    @cached_property
    def fixed(self) -> int:
        """Number of degrees of freedom that a penalty fixes, which add no mode."""
        if not self.pencil.is_dense:
            # sparse factors are not troubled by them; they are only counted
            return beyond_gap(
                self.pencil.mass.diagonal(), self.pencil.stiffness.diagonal()
            )
        mass, damping, stiffness = self.pencil.dense
        return int(stiff_degrees(mass, stiffness, damping).sum())

    @property
    def residuals(self) -> Any:
        """‖Q(s) v‖ over the sum of the norms of its three terms."""
        s, v, pencil = self.values, self.shapes, self.pencil
        modal = 0.0 if pencil.modal is None else pencil.modal.product(v)
        terms = (
            pencil.mass @ v * s**2,
            (pencil.damping @ v + modal) * s,
            pencil.stiffness @ v,
        )
        size = sum(np.linalg.norm(term, axis=0) for term in terms)
        missed = np.linalg.norm(terms[0] + terms[1] + terms[2], axis=0)
        return missed / np.where(size > 0, size, 1.0)


@dataclass(frozen=True)
class Limits:
    """Limits of the modes that are asked for.

    Attributes:
        frequency_max: Hz.
        n_modes: how many, by frequency.
    """

    frequency_max: float | None = None
    n_modes: int | None = None

    @property
    def takes_all(self) -> bool:
        """True if there are none."""
        return self.frequency_max is None and self.n_modes is None

    def as_dict(self) -> dict[str, float | None]:
        """Both by name."""
        return {"frequency_max": self.frequency_max, "n_modes": self.n_modes}


def check_frequency(frequency_max: float | None) -> None:
    """Refuse a limit of frequencies, Hz, that is none."""
    if frequency_max is not None and not (
        is_finite_number(frequency_max) and frequency_max > 0
    ):
        raise ValueError(
            f"frequency_max = {brief(frequency_max)}: a number greater than 0, Hz, is needed"
        )


@dataclass
class Solver:
    """Modes of one structure at any friction and one belt speed; remembers them.

    Attributes:
        varied: what the friction stands for; None: the structure's ``mu``.
        modal: damping of single modes.
    """

    structure: ContactStructure
    limits: Limits
    belt_speed: float
    varied: VariedFriction | None = None
    modal: LowRank | None = None
    _known: dict[float, Spectrum] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.structure = self.structure.at_speed(self.belt_speed)
        self.modal = modal_damping_of(
            self.structure,
            None if self.is_dense else self.limits.n_modes,
            self._omega_max,
        )

    @property
    def is_dense(self) -> bool:
        """True if all eigenvalues are computed."""
        return self.structure.size <= DENSE

    @property
    def _omega_max(self) -> float | None:
        frequency = self.limits.frequency_max
        return None if self.is_dense or frequency is None else 2 * np.pi * frequency

    def sliding(self, mu: float) -> SteadySliding:
        """Steady sliding at this friction.

        Raises:
            NoSlidingError: there is none.
        """
        varied = self.varied or VariedFriction.common(self.structure)
        coefficients = varied.of_contacts(self.structure, mu)
        return steady_sliding(self.structure, coefficients, self.belt_speed)

    def pencil(self, mu: float) -> Pencil:
        """Return the matrices of small motions at this friction."""
        return pencil_about(self.structure, self.sliding(mu), self.modal)

    def at(self, mu: float) -> Spectrum:
        """All modes of a dense structure, those within the limits of a sparse one.

        Raises:
            NoSlidingError: there is no steady sliding.
            IncompleteError: a band could not be shown to be complete.
        """
        if mu not in self._known:
            state = self.sliding(mu)
            pencil = pencil_about(self.structure, state, self.modal)
            find: Callable[[Pencil], list[Eigenpair]]
            find = dense.all_modes if self.is_dense else self._within
            pairs = with_errors_of_forces(pencil, find(pencil))
            self._known[mu] = Spectrum(mu, state, pencil, pairs)
        return self._known[mu]

    def _within(self, pencil: Pencil) -> list[Eigenpair]:
        omega, number = self._omega_max, self.limits.n_modes
        if number is None:
            assert omega is not None  # noqa: S101 (large structures have a limit)
            return growing_first(band.modes_in_band(pencil, omega))
        lowest, _ = modes_at_rest(self.structure, number)
        # the band of so many modes ends so far beyond the frequency that they reach without
        # friction
        beyond_the_band = 1.05
        reach = beyond_the_band * lowest[-1]
        while True:
            top = reach if omega is None else min(reach, omega)
            pairs = growing_first(band.modes_in_band(pencil, top))
            if len(pairs) >= number or top == omega:
                return pairs[:number]
            reach *= 1.3

    def selected(self, spectrum: Spectrum) -> np.ndarray:
        """Return which modes are within the limits, (modes,)."""
        frequency = spectrum.values.imag / (2 * np.pi)
        chosen = np.ones(len(frequency), bool)
        if self.limits.frequency_max is not None:
            chosen &= frequency <= self.limits.frequency_max
        if self.limits.n_modes is not None:
            ordered = growing_first(spectrum.pairs)
            place = {id(pair): rank for rank, pair in enumerate(ordered)}
            rank = np.array([place[id(pair)] for pair in spectrum.pairs], int)
            within = np.sort(rank[chosen])[: self.limits.n_modes]
            chosen &= np.isin(rank, within)
        return chosen
