"""Hill's method against the exact monodromy, and how sampling spoils it."""

import math

import numpy as np
import pytest

from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.balance.harmonic_balance import CosineBalance, contact_of
from squealpipe.brake.balance.hill import hill_multipliers
from squealpipe.paper.comparison.work_precision import orbit_series
from tests.former import FORMER

SCENE = scaled_system(FORMER, 0.3 * math.pi, 0.9 * math.pi)


def share_above(contact_angles, n_harmonics):
    """Cosine means of the part of the period spent above, 0 … 2 H, in closed form.

    Args:
        contact_angles: θ in (0, π) at which y crosses the threshold, ascending; above at θ = 0.
        n_harmonics: H.
    """
    edges = np.concatenate([[0.0], contact_angles, [math.pi]])
    begin, end = edges[:-1:2], edges[1::2]
    order = np.arange(1, 2 * n_harmonics + 1)
    share = np.empty(2 * n_harmonics + 1)
    share[0] = (end - begin).sum() / math.pi
    share[1:] = (np.sin(np.outer(order, end)) - np.sin(np.outer(order, begin))).sum(
        axis=1
    )
    share[1:] /= math.pi * order
    return share


def solved(y_peak, n_harmonics):
    orbit, _ = find_orbit(SCENE, 1, y_peak)
    assert orbit is not None
    balance = CosineBalance(SCENE.system, contact_of(n_harmonics, None, None))
    found = balance.solve(
        orbit_series(SCENE, orbit, n_harmonics), balance.peak_row, y_peak
    )
    assert found is not None
    _, y, omega = balance.split(found[0])
    return balance, y, omega, orbit.stability_index


@pytest.mark.parametrize("y_peak", [4.0, 4.5, 5.0])
def test_closed_form_coefficients_give_the_true_doubling_multiplier(y_peak):
    balance, y, omega, index = solved(y_peak, 16)
    share = share_above(balance.contact.angles(y), 16)
    largest = np.abs(hill_multipliers(SCENE.system, share, omega)).max()
    assert index < -2.0
    assert largest == pytest.approx(
        (-index + math.sqrt(index * index - 4.0)) / 2.0, abs=2e-3
    )
