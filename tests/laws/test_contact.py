"""The contact spring: sharp, regularized, and its linearization of Eq. (8d)."""

import math

import mpmath
import numpy as np
import pytest

from squealpipe.laws import contact
from tests import symbols
from tests.former import FORMER

FORCE = symbols.function(symbols.CONTACT_FORCE)


@pytest.mark.parametrize(("params", "state"), symbols.draws(10))
def test_force_is_minus_the_slope_of_the_energy(params, state):
    y = state["y"]
    assert contact.contact_force(y, params) == pytest.approx(
        float(FORCE(params, y=y)), rel=1e-14
    )


@pytest.mark.parametrize("y", [-1.0, 0.0, 0.99, 1.0, 1.01, 3.0])
def test_regularized_force_is_the_printed_one(y):
    params, sigma = FORMER.with_(k3=0.7), 3.0
    printed = -0.5 * 0.7 * (y - 1.0) * (1.0 + math.tanh(sigma * (1.0 - y)))
    assert contact.regularized_force(y, params, sigma) == pytest.approx(
        printed, rel=1e-14
    )


def test_regularized_force_tends_to_the_sharp_one_like_one_over_sigma():
    params = FORMER
    errors = []
    for sigma in (1e1, 1e2, 1e3):
        y = 1.0 + np.linspace(-3.0, 3.0, 601) / sigma
        smooth = contact.regularized_force(y, params, sigma)
        sharp = np.maximum(contact.contact_force(y, params), 0.0)
        errors.append(np.abs(smooth - sharp).max())
    np.testing.assert_allclose(np.diff(np.log10(errors)), -1.0, atol=1e-6)


@pytest.mark.parametrize("y", [-0.7, 0.0, 0.9, 1.0, 1.2])
@pytest.mark.parametrize("sigma", [0.5, 4.0, 30.0])
def test_slope_of_the_regularized_force(y, sigma):
    with mpmath.workdps(40):
        slope = mpmath.diff(
            lambda u: (1 - u) * (1 + mpmath.tanh(sigma * (1 - u))) * 0.75 / 2, y
        )
    stiffness = 0.75 * contact.smoothed_compression_slope(1.0 - y, sigma)
    assert stiffness == pytest.approx(-float(slope), rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("reach", [0.01, 0.5, 1.2, 5.0, 40.0])
def test_linearized_stiffness_is_the_printed_k3(reach):
    """It overshoots, by 10 % at 1.2, and settles."""
    params, t = FORMER.with_(k3=0.8, preload=2.0), math.tanh(reach)
    printed = 0.5 * 0.8 * (t + reach - reach * t**2 + 1)
    found = contact.linearized_contact_stiffness(params, reach / 2.0)
    assert found == pytest.approx(printed, rel=1e-13)
