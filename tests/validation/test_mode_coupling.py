"""A published mode-coupling model by our own A3.

Hoffmann, Fischer, Allgaier and Gaul, "A minimal model for studying properties of the
mode-coupling type instability in friction induced oscillations", Mechanics Research
Communications 29 (2002) 197–205. With y reversed, its matrix [[2, −1 + 4μ/3], [−1, 2]] for m = 1 is
ours for equal angles of π/6 and the stiffnesses below: s² = −2 ± √(1 − 4μ/3).
"""

import math

import mpmath
import numpy as np
import pytest
import scipy.linalg

from squealpipe.laws.springs import Geometry, geometry, linear_stiffness
from squealpipe.models.a4 import contact_matrix
from squealpipe.parameters import Parameters
from squealpipe.tasks.linear.maps import stability_map

ANGLE = math.pi / 6
ONSET = 0.75
"""The published friction coefficient at which the modes merge."""


def published(mu):
    """Our parameters that give the published stiffness matrix."""
    return Parameters(k1=2 / 3 * (2 - math.sqrt(3)), k2=2 / 3 * (2 + math.sqrt(3)), k3=4 / 3, mu=mu)


def eigenvalues(mu):
    """The two s of A3 in the upper right quarter plane."""
    cell = stability_map(published(mu), [ANGLE], [ANGLE]).isel(alpha1=0, alpha2=0)
    return np.asarray(cell.growth_rate.values + 1j * cell.frequency.values)


@pytest.mark.parametrize("mu", [0.0, 0.4, 0.75, 1.2])
def test_our_matrix_is_the_published_one(mu):
    params = published(mu)
    stiffness = linear_stiffness(params, geometry(ANGLE, ANGLE))
    matrix = contact_matrix(stiffness, params.k3, params.mu)
    np.testing.assert_allclose(matrix, [2.0, -1.0 + 4 * mu / 3, -1.0, 2.0], rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("mu", [0.0, 0.1, 0.5, 0.7, 0.749, 0.751, 0.8, 1.0, 1.5])
def test_frequencies_and_growth_follow_the_published_formula(mu):
    root = np.sqrt(1 - 4 / 3 * mu + 0j)
    s = np.sqrt([-2 + root, -2 - root])
    expected = np.abs(s.real) + 1j * np.abs(s.imag)
    np.testing.assert_allclose(eigenvalues(mu), expected, rtol=1e-13, atol=1e-14)


def test_the_modes_merge_at_the_published_friction():
    for mu, regime in ((ONSET * (1 - 1e-12), 0), (ONSET * (1 + 1e-12), 1)):
        cell = stability_map(published(mu), [ANGLE], [ANGLE]).isel(alpha1=0, alpha2=0)
        assert int(cell.regime_linear) == regime
        np.testing.assert_allclose(cell.frequency, math.sqrt(2), rtol=1e-6)


def test_growth_beyond_the_onset_is_a_square_root():
    growth = [eigenvalues(ONSET * (1 + gap)).real.max() for gap in (1e-8, 1e-6, 1e-4)]
    np.testing.assert_allclose(np.diff(np.log10(growth)), 1.0, atol=1e-3)


@pytest.mark.parametrize("side", [-1, 1])
def test_closed_form_keeps_its_digits_where_numeric_eigenvalues_lose_half(side):
    """Against 60 digits, next to the onset, where the matrix is defective."""
    for gap in (1e-15, 1e-14, 1e-8, 0.1):
        params = published(ONSET * (1 + side * gap))
        with mpmath.workdps(60):
            reference = _exact(params)
        assert _distance(eigenvalues(params.mu), reference) < 1e-15
        stiffness = linear_stiffness(params, geometry(ANGLE, ANGLE))
        numeric = scipy.linalg.eigvals(
            _first_order(contact_matrix(stiffness, params.k3, params.mu))
        )
        assert _distance(numeric, reference) > 1e-10 or gap > 1e-14


def _first_order(matrix):
    a11, a12, a21, a22 = matrix
    return [[0, 0, 1, 0], [0, 0, 0, 1], [-a11, -a12, 0, 0], [-a21, -a22, 0, 0]]


def _exact(params):
    cosine, sine = mpmath.cos_sin(mpmath.mpf(ANGLE))
    stiffness = linear_stiffness(params, Geometry(cosine, sine, cosine, sine))
    matrix = contact_matrix(stiffness, mpmath.mpf(params.k3), params.mu)
    exact = mpmath.eig(mpmath.matrix(_first_order(matrix)), right=False)
    return [complex(value) for value in exact if value.imag > 0]


def _distance(found, reference):
    """Largest over the reference of the relative distance to the nearest found eigenvalue."""
    mirrored = np.concatenate([found, -np.conj(found)])
    return max(float(np.abs(mirrored - value).min() / abs(value)) for value in reference)
