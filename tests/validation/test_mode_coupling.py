"""Hoffmann, Fischer, Allgaier and Gaul (2002), reproduced by our own A3."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.models.a4 import contact_matrix
from squealpipe.tasks.linear.maps import stability_map
from squealpipe.tasks.linear.mode_coupling import ANGLE, ONSET, mode_coupling, published_parameters


@pytest.fixture(scope="module")
def coupling() -> object:
    return mode_coupling()


@pytest.mark.parametrize("mu", [0.0, 0.4, 0.75, 1.2])
def test_our_matrix_is_the_published_one(mu: float) -> None:
    """[[2, −1 + 4μ/3], [−1, 2]] for m = 1: normal stiffness 2/3 + 4/3."""
    params = published_parameters(mu)
    stiffness = linear_stiffness(params, geometry(ANGLE, ANGLE))
    matrix = contact_matrix(stiffness, params.k3, params.mu)
    np.testing.assert_allclose(matrix, [2.0, -1.0 + 4 * mu / 3, -1.0, 2.0], rtol=1e-14, atol=1e-15)


def test_both_frequencies_and_the_growth_follow_the_published_formula(coupling: object) -> None:
    """s² = −2 ± √(1 − 4μ/3); at the onset itself a rounded parameter moves s by 1e-8."""
    away = np.abs(coupling.mu / ONSET - 1) > 1e-9
    for name in ("frequency", "growth_rate"):
        ours, published = coupling[name][away], coupling[f"published_{name}"][away]
        np.testing.assert_allclose(ours, published, rtol=1e-13, atol=1e-14)


def test_the_modes_merge_at_the_published_friction() -> None:
    for mu, regime in ((ONSET * (1 - 1e-12), 0), (ONSET * (1 + 1e-12), 1)):
        cell = stability_map(published_parameters(mu), [ANGLE], [ANGLE]).isel(alpha1=0, alpha2=0)
        assert int(cell.regime_linear) == regime
        np.testing.assert_allclose(cell.frequency, math.sqrt(2), rtol=1e-6)


def test_growth_beyond_the_onset_is_a_square_root(coupling: object) -> None:
    beyond = [ONSET * (1 + gap) for gap in (1e-8, 1e-6, 1e-4)]
    growth = [
        float(stability_map(published_parameters(mu), [ANGLE], [ANGLE]).growth_rate[0, 0])
        for mu in beyond
    ]
    np.testing.assert_allclose(np.diff(np.log10(growth)), 1.0, atol=1e-3)
    assert (coupling.growth_rate[coupling.mu < ONSET * (1 - 1e-9)] == 0).all()


def test_closed_form_keeps_its_digits_where_numeric_eigenvalues_lose_half(
    coupling: object,
) -> None:
    assert float(coupling.closed_form_error.max()) < 1e-15
    nearest = coupling.numeric_error.sel(distance=coupling.distance < 1e-13)
    assert float(nearest.max()) > 1e-10
