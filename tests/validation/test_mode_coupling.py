"""A published mode-coupling model by our own A3.

Hoffmann, Fischer, Allgaier and Gaul, "A minimal model for studying properties of the
mode-coupling type instability in friction induced oscillations", Mechanics Research
Communications 29 (2002) 197–205. With y reversed, its matrix [[2, −1 + 4μ/3], [−1, 2]] for m = 1 is
ours for equal angles of π/6 and the stiffnesses below: s² = −2 ± √(1 − 4μ/3).
"""

import math

import numpy as np
import pytest

from squealpipe.brake.linear.maps import stability_map
from squealpipe.parameters import Parameters

ANGLE = math.pi / 6
ONSET = 0.75
"""The published friction coefficient at which the modes merge."""


def published(mu):
    """Our parameters that give the published stiffness matrix."""
    return Parameters(
        k1=2 / 3 * (2 - math.sqrt(3)), k2=2 / 3 * (2 + math.sqrt(3)), k3=4 / 3, mu=mu
    )


def eigenvalues(mu):
    """The two s of A3 in the upper right quarter plane."""
    cell = stability_map(published(mu), [ANGLE], [ANGLE]).isel(alpha1=0, alpha2=0)
    return np.asarray(cell.growth_rate.values + 1j * cell.frequency.values)


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
