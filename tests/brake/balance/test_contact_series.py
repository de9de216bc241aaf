"""Contact integrals in closed form against quadrature, differences and dense sampling."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from squealpipe.brake.balance.contact_series import ClosedFormContact, SampledContact
from tests.oracles.differences import assert_jacobian

GENERATOR = np.random.default_rng(5)
SERIES = {
    "one flight": np.array([0.4, 1.2, 0.1, 0.05]),
    "two flights": np.array([0.6, 0.2, 0.9, 0.1]),
    "contact throughout": np.array([0.2, 0.3, 0.1, 0.0]),
    "no contact": np.array([3.0, 0.3, 0.1, 0.0]),
    "contact at the peak": np.array([0.8, -0.9, 0.2, 0.1]),
    "many harmonics": np.concatenate([[0.5, 1.0], GENERATOR.normal(0, 0.05, 14)]),
}


def _gap_coefficient(cosine, order):
    def integrand(theta):
        y = np.cos(theta * np.arange(len(cosine))) @ cosine
        return max(1.0 - y, 0.0) * math.cos(order * theta)

    breaks = ClosedFormContact(len(cosine) - 1, 1.0).angles(cosine)
    value = quad(
        integrand, 0, math.pi, points=breaks if len(breaks) else None, limit=400
    )[0]
    return value * (1 if order == 0 else 2) / math.pi


@pytest.mark.parametrize("cosine", SERIES.values(), ids=SERIES)
def test_coefficients_agree_with_quadrature(cosine):
    gap, _ = ClosedFormContact(len(cosine) - 1, 1.0).gap(cosine)
    expected = [_gap_coefficient(cosine, order) for order in range(len(cosine))]
    np.testing.assert_allclose(gap, expected, atol=1e-12)


@pytest.mark.parametrize("cosine", SERIES.values(), ids=SERIES)
@pytest.mark.parametrize("kind", ["closed form", "tanh samples"])
def test_jacobians_agree_with_differences(cosine, kind):
    order = len(cosine) - 1
    closed = ClosedFormContact(order, 1.0)
    contact = closed if kind == "closed form" else SampledContact(order, 1.0, 256, 20.0)
    assert_jacobian(contact.gap, cosine, atol=1e-7)


def test_contact_angles_of_one_harmonic_are_arc_cosines():
    angles = ClosedFormContact(4, 1.0).angles(np.array([0.3, 1.1, 0.0, 0.0, 0.0]))
    np.testing.assert_allclose(angles, [math.acos(0.7 / 1.1)], rtol=1e-15)


@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-6])
def test_a_touch_between_grid_points_is_found(height):
    """y = 1 + height − 2 sin²(θ − θ0)-like hump, narrower than the grid of four harmonics."""
    cosine = np.array([0.0, 0.0, -1.0 - height, 0.0, 0.0])
    angles = ClosedFormContact(4, 1.0).angles(cosine)
    half_width = math.asin(math.sqrt(0.5 * height / (1.0 + height)))
    edges = 0.5 * math.pi + half_width * np.array([-1.0, 1.0])
    np.testing.assert_allclose(angles, edges, atol=1e-9)


def test_samples_converge_to_the_closed_form():
    cosine = SERIES["two flights"]
    exact, _ = ClosedFormContact(3, 1.0).gap(cosine)
    counts = 64, 256, 1024, 4096
    errors = [
        np.abs(SampledContact(3, 1.0, n).gap(cosine)[0] - exact).max() for n in counts
    ]
    rate = np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert rate < -1.7
