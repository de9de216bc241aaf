"""The linear chain: angles → stiffness → spectrum of the mass in contact, for A2, A3 and A4."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.models.a2 import FEW_ULPS
from squealpipe.brake.models.a4 import StiffnessSpectrum, spectrum
from squealpipe.laws import springs
from squealpipe.laws.friction_laws import coefficient, static_coefficient
from squealpipe.parameters import direction_of


def with_drag(fields: Mapping[str, Any]) -> SimpleNamespace:
    """Parameters, each of which may be an array, with μs and the drag that follow from them."""
    p = SimpleNamespace(**fields)
    p.static_mu = static_coefficient(p)
    p.drag = direction_of(p.belt_speed) * coefficient(np.abs(p.belt_speed), p)
    return p


class ContactSystem(NamedTuple):
    """Stiffness and static state of a pair of angles, for the linear levels.

    Attributes:
        stiffness: K11, K12, K22, N/m.
        spring_determinant: det K, N²/m²; 0 where α1 + α2 is a multiple of π but for rounding.
        invariants: of the matrix whose eigenvalues are ω², with the signed friction μ sgn V.
    """

    stiffness: springs.Stiffness
    spring_determinant: Any
    invariants: StiffnessSpectrum


def contact_system(
    p: Any, alpha1: Any, alpha2: Any, *, k3: Any = None
) -> ContactSystem:
    """The linear system at angles and parameters that broadcast against one another.

    Args:
        p: ``Parameters``, or any object with mass, k1, k2, k3 and drag (μ sgn V); each may be
            an array, one entry a parameter set.
        k3: contact stiffness in place of ``p.k3``, N/m: 0 when separated.
    """
    stiffness = springs.linear_stiffness(p, springs.geometry(alpha1, alpha2))
    sine = springs.sine_of_sum(alpha1, alpha2)
    determinant = springs.pair_determinant(
        p.k1, p.k2, np.where(np.abs(sine) <= FEW_ULPS, 0.0, sine)
    )
    invariants = spectrum(
        stiffness, determinant, k3=p.k3 if k3 is None else k3, mu=p.drag, mass=p.mass
    )
    return ContactSystem(stiffness, determinant, invariants)
