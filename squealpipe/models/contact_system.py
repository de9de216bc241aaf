"""The linear chain: angles → stiffness → spectrum of the mass in contact, for A2, A3 and A4."""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.springs import (
    Stiffness,
    determinant_from_sine,
    geometry,
    linear_stiffness,
    sine_of_sum,
)
from squealpipe.models.a2 import FEW_ULPS
from squealpipe.models.a4 import Spectrum, spectrum


class ContactSystem(NamedTuple):
    """What the linear levels know of a pair of angles.

    Attributes:
        stiffness: K11, K12, K22, N/m.
        spring_determinant: det K, N²/m²; 0 where α1 + α2 is a multiple of π but for rounding.
        invariants: of the matrix whose eigenvalues are ω², with the signed friction μ sgn V.
    """

    stiffness: Stiffness
    spring_determinant: Any
    invariants: Spectrum


def contact_system(p: Any, alpha1: Any, alpha2: Any, *, k3: Any = None) -> ContactSystem:
    """The linear system at angles and parameters that broadcast against one another.

    Args:
        p: ``Parameters``, or any object with mass, k1, k2, k3 and drag (μ sgn V); each may be
            an array, one entry a parameter set.
        alpha1, alpha2: angles, rad.
        k3: contact stiffness in place of ``p.k3``, N/m: 0 when separated.
    """
    stiffness = linear_stiffness(p, geometry(alpha1, alpha2))
    determinant = spring_determinant(p, alpha1, alpha2)
    invariants = spectrum(
        stiffness, determinant, k3=p.k3 if k3 is None else k3, mu=p.drag, mass=p.mass
    )
    return ContactSystem(stiffness, determinant, invariants)


def spring_determinant(p: Any, alpha1: Any, alpha2: Any) -> Any:
    """det K, N²/m²; 0 where α1 + α2 is a multiple of π but for the rounding of π."""
    sine = sine_of_sum(alpha1, alpha2)
    return determinant_from_sine(p, np.where(np.abs(sine) <= FEW_ULPS, 0.0, sine))
