"""Scale model A4 at one pair of angles to a piecewise-linear system, with its linear modes.

Idea: in units of l_pre and of 1/√(tr K_contact/2m) every unknown is of order one, so that one
tolerance serves all brakes, and the contact ends at y = 1. What has no periodic motions about the
contact state, because it has no equilibrium or no stable mode there, is named by an outcome.
Invariant: numbers so large or small that products of four of them are no doubles are refused.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.models import a2, a4
from squealpipe.brake.models.refusals import WHY_A4, refuse_extensions
from squealpipe.brake.orbits.piecewise_linear import LinearState, PiecewiseLinearSystem
from squealpipe.laws import springs
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome


@dataclass(frozen=True)
class ScaledSystem:
    """A4 in units of l_pre and of 1/√(tr K_contact/2m), which make every unknown of order one.

    Attributes:
        system: ``below`` is contact, ``above`` separation; threshold 1.
        frequency: unit of frequency, rad/s.
        rest: equilibrium in contact, scaled; NaN without one.
        squared: (ω1², ω2²) in contact, scaled.
        obstacle: why there are no periodic motions about the contact state, or ``converged``.
    """

    system: PiecewiseLinearSystem
    length: float
    frequency: float
    rest: NDArray[np.float64]
    squared: tuple[complex, complex]
    obstacle: Outcome

    def omega(self, mode: int) -> float:
        """Angular frequency of a linear mode in contact, scaled."""
        return math.sqrt(self.squared[mode - 1].real)

    @property
    def isolated_mode(self) -> int | None:
        """The mode that is pure x motion (K12 = 0), or None."""
        if not self.system.decoupled:
            return None
        own = self.system.below.matrix[0][0]
        return min((1, 2), key=lambda mode: abs(self.squared[mode - 1].real - own))

    def slope(self, mode: int) -> float:
        """x over y in the linear mode in contact, from the better conditioned row."""
        (a11, a12), (a21, a22) = self.system.below.matrix
        squared = self.squared[mode - 1].real
        if a21 == 0.0 or abs(a11 - squared) > abs(a22 - squared):
            return -a12 / (a11 - squared) if a11 != squared else math.inf
        return -(a22 - squared) / a21


def scaled_system(params: Parameters, alpha1: float, alpha2: float) -> ScaledSystem:
    """Model A4 as two linear states joined at y = l_pre.

    K12 counts as zero where only round-off keeps it from it, so that decoupled scenes such as
    (π/2, π) are decoupled.
    """
    refuse_extensions(params, "model A4", WHY_A4)
    # mass, stiffness and their inverse: products of four of them are doubles
    largest = 1e70
    for name in ("mass", "k1", "k2", "k3"):
        if not 1.0 / largest <= getattr(params, name) <= largest:
            raise ValueError(
                f"{name} = {getattr(params, name)!r}: between {1.0 / largest:g} and {largest:g} "
                "is needed, where squares neither vanish nor overflow; choose other units"
            )
    g = springs.Geometry(
        *map(float, springs.geometry(float(alpha1), float(alpha2)))
    )  # NumPy's scalars are slow
    stiffness = springs.linear_stiffness(params, g)
    if a2.coupling_is_zero(stiffness):
        stiffness = springs.Stiffness(stiffness.k11, 0.0, stiffness.k22)
    determinant, drag = float(springs.stiffness_determinant(params, g)), params.drag
    invariants = a4.spectrum(
        stiffness, determinant, k3=params.k3, mu=drag, mass=params.mass
    )
    unit = float(invariants.half_trace)
    larger, smaller = (
        value / unit for value in a4.natural_frequencies_squared(invariants)[::-1]
    )

    a11, a12, a21, a22 = (
        float(value) / (params.mass * unit)
        for value in a4.contact_matrix(stiffness, params.k3, drag)
    )
    push = params.k3 / (params.mass * unit)
    contact = LinearState(((a11, a12), (a21, a22)), (drag * push, push))
    separated = LinearState(
        ((a11, a12 - drag * push), (a21, float(stiffness.k22) / (params.mass * unit))),
        (0.0, 0.0),
    )
    system = PiecewiseLinearSystem(contact, separated, 1.0)
    contact_determinant = float(invariants.determinant) / unit**2
    gap = (
        determinant / (params.mass * unit) ** 2 / contact_determinant
        if contact_determinant
        else 0.0
    )
    return ScaledSystem(
        system=system,
        length=params.preload,
        frequency=math.sqrt(unit),
        rest=contact.equilibrium if contact_determinant else np.full(2, np.nan),
        squared=(complex(smaller), complex(larger)),
        obstacle=_obstacle(invariants, gap),
    )


def _obstacle(invariants: a4.StiffnessSpectrum, gap: float) -> Outcome:
    """``gap`` is (l_pre − y*)/l_pre, det K over det K_contact."""
    if invariants.discriminant < 0.0:
        return Outcome.complex_pair
    if invariants.determinant < 0.0:
        return Outcome.divergence
    # relative to the squared half trace: below it ω1 is zero to round-off, and its period without
    # end
    if invariants.determinant <= 1e-14 * invariants.half_trace**2:
        return Outcome.rigid_mode
    # closer natural frequencies are one, to round-off
    if not gap > 1e-9:
        return Outcome.singular_static_state
    return Outcome.converged
