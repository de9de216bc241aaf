"""External validation: a published mode-coupling model, by our own A3.

Hoffmann, Fischer, Allgaier and Gaul, "A minimal model for studying properties of the
mode-coupling type instability in friction induced oscillations", Mechanics Research
Communications 29 (2002) 197–205. With y reversed, its matrix [[2, −1 + μk3], [−1, 2]] is ours for
equal angles of π/6 and the stiffnesses below.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
import scipy.linalg
import xarray as xr

from squealpipe.laws.springs import Geometry, linear_stiffness
from squealpipe.models.a4 import contact_matrix
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.linear import MODE_COUPLING
from squealpipe.tasks.linear.maps import stability_map

ANGLE = math.pi / 6
ONSET = 0.75
"""The published friction coefficient at which the modes merge."""
REFERENCE_DIGITS = 60


def published_parameters(mu: float) -> Parameters:
    """Our parameters that give the published stiffness matrix."""
    return Parameters(k1=2 / 3 * (2 - math.sqrt(3)), k2=2 / 3 * (2 + math.sqrt(3)), k3=4 / 3, mu=mu)


def published_eigenvalues(mu: np.ndarray) -> np.ndarray:
    """s with s² = −2 ± √(1 − 4μ/3), upper half plane, shape (mu, mode), 1/s."""
    root = np.sqrt(1 - 4 / 3 * mu + 0j)
    s = np.sqrt(np.stack([-2 + root, -2 - root], axis=-1))
    return np.asarray(np.abs(s.real) + 1j * np.abs(s.imag))


def mode_coupling(*, points: int = 151, mu_max: float = 1.5) -> xr.Dataset:
    """Both frequencies and the growth rate against friction, and accuracy next to the onset.

    Args:
        points: friction coefficients from 0 to ``mu_max``.
        mu_max: largest friction coefficient.

    Returns:
        Dataset over (mu, mode) by A3 and by the published formula, and over (side, distance) the
        relative errors of the closed form and of ``scipy.linalg.eig`` against
        ``mpmath`` with 60 digits.
    """
    mu = np.linspace(0.0, mu_max, points)
    published = published_eigenvalues(mu)
    ours = np.array([_own_eigenvalues(value) for value in mu])
    distance = np.geomspace(1e-15, 0.1, 29)
    errors = np.array([[_errors(ONSET * (1 + sign * gap)) for gap in distance] for sign in (-1, 1)])
    return build(
        MODE_COUPLING,
        {
            "growth_rate": ours.real.max(axis=-1),
            "frequency": ours.imag,
            "published_growth_rate": published.real.max(axis=-1),
            "published_frequency": published.imag,
            "closed_form_error": errors[..., 0],
            "numeric_error": errors[..., 1],
        },
        {"mu": mu, "mode": [1, 2], "distance": distance, "side": ["stable", "flutter"]},
    )


def _own_eigenvalues(mu: float) -> np.ndarray:
    """The two s of A3 in the upper right quarter plane."""
    cell = stability_map(published_parameters(mu), np.array([ANGLE]), np.array([ANGLE])).isel(
        alpha1=0, alpha2=0
    )
    return np.asarray(cell.growth_rate.values + 1j * cell.frequency.values)


def _errors(mu: float) -> tuple[float, float]:
    """Largest relative error over the spectrum: closed form, numeric eigenvalues."""
    params = published_parameters(mu)
    cosine, sine = math.cos(ANGLE), math.sin(ANGLE)
    stiffness = linear_stiffness(params, Geometry(cosine, sine, cosine, sine))
    a11, a12, a21, a22 = contact_matrix(stiffness, params.k3, params.mu)
    numeric = scipy.linalg.eig([[0, 0, 1, 0], [0, 0, 0, 1], [-a11, -a12, 0, 0], [-a21, -a22, 0, 0]])
    own = _own_eigenvalues(mu)
    with mpmath.workdps(REFERENCE_DIGITS):
        cosine, sine = mpmath.cos_sin(mpmath.mpf(ANGLE))
        stiffness = linear_stiffness(params, Geometry(cosine, sine, cosine, sine))
        a11, a12, a21, a22 = contact_matrix(stiffness, mpmath.mpf(params.k3), params.mu)
        exact = mpmath.eig(
            mpmath.matrix([[0, 0, 1, 0], [0, 0, 0, 1], [-a11, -a12, 0, 0], [-a21, -a22, 0, 0]]),
            right=False,
        )
        reference = [complex(value) for value in exact if value.imag > 0]
    return _distance(own, reference), _distance(numeric[0], reference)


def _distance(found: np.ndarray, reference: list[complex]) -> float:
    """Largest over the reference of the relative distance to the nearest found eigenvalue."""
    mirrored = np.concatenate([found, -np.conj(found)])
    return max(float(np.abs(mirrored - value).min() / abs(value)) for value in reference)
