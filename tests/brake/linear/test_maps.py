"""Linear maps against high-precision eigenvalues, numeric eigenvalues and algebra."""

import math

import mpmath
import numpy as np
import pytest
import scipy.linalg
import scipy.optimize

from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from squealpipe.schema import Outcome
from tests import symbols
from tests.former import FORMER
from tests.oracles import sliding

BASELINE = FORMER
ANGLES = np.linspace(0.0, np.pi, 181)
UNEQUAL = FORMER.with_(mass=1.7, k1=1.4, k2=0.6, k3=0.9, mu=0.45, preload=0.5)
SEED = 11


def relative_error(params, alpha1, alpha2):
    cell = stability_map(params, [alpha1], [alpha2]).isel(alpha1=0, alpha2=0)
    growth, (low, high) = float(cell.growth_rate), cell.frequency.values
    pairs = (
        [growth, 1j * high]
        if cell.regime_linear == 2
        else growth + 1j * np.array([low, high])
    )
    own = np.concatenate(
        [sign * np.array(each) for each in (pairs, np.conj(pairs)) for sign in (1, -1)]
    )
    exact = sliding.eigenvalues(params, alpha1, alpha2)
    return max(float(np.abs(own - value).min() / abs(value)) for value in exact)


@pytest.mark.parametrize("params", [BASELINE, UNEQUAL, BASELINE.with_(mu=0.8, k3=1.3)])
def test_eigenvalues_to_thirteen_digits(params):
    generator = np.random.default_rng(SEED)
    worst = max(
        relative_error(params, *generator.uniform(0, np.pi, 2)) for _ in range(20)
    )
    assert worst < 1e-13


def onset(params, alpha2, low, high):
    """The α1 of flutter onset, where the two squares of the high-precision matrix meet."""

    def discriminant(alpha1):
        m = sliding.first_order_matrix(params, alpha1, alpha2)[2:, :2]
        return float(((m[0, 0] - m[1, 1]) / 2) ** 2 + m[0, 1] * m[1, 0])

    with mpmath.workdps(40):
        return float(
            scipy.optimize.brentq(discriminant, low, high, xtol=1e-16, rtol=1e-15)
        )


@pytest.mark.parametrize("ulps", [-40, -3, -1, 0, 1, 3, 40])
def test_eigenvalues_to_twelve_digits_at_the_onset_of_flutter(ulps):
    """The nearest floating-point angles to the onset, where numeric eigenvalues fail."""
    alpha2 = 0.23 * math.pi
    alpha1 = onset(BASELINE, alpha2, 0.05 * math.pi, 0.14 * math.pi)
    alpha1 += ulps * np.spacing(alpha1)
    assert relative_error(BASELINE, alpha1, alpha2) < 1e-12
    whole = sliding.first_order_matrix(BASELINE, alpha1, alpha2)
    numeric = np.linalg.eigvals(np.array(whole.tolist(), dtype=float))
    reference = sliding.eigenvalues(BASELINE, alpha1, alpha2)
    lost = max(float(np.abs(numeric - value).min() / abs(value)) for value in reference)
    assert lost > 1e-10


@pytest.mark.parametrize("distance", [1e-14, 1e-10, 1e-6, 1e-3])
def test_growth_rates_next_to_both_boundaries(distance):
    """Growth itself keeps twelve digits, though it is a small difference of large numbers."""
    alpha2 = 0.23 * math.pi
    flutter = onset(BASELINE, alpha2, 0.05 * math.pi, 0.14 * math.pi) + distance

    def determinant(alpha1):
        m = sliding.first_order_matrix(BASELINE, alpha1, 0.55 * math.pi)[2:, :2]
        return float(m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0])

    with mpmath.workdps(40):
        divergence = scipy.optimize.brentq(
            determinant, 0.3 * math.pi, 0.45 * math.pi, xtol=1e-16
        )
    for alpha1, second in ((flutter, alpha2), (divergence + distance, 0.55 * math.pi)):
        exact = max(s.real for s in sliding.eigenvalues(BASELINE, alpha1, second))
        found = float(stability_map(BASELINE, [alpha1], [second]).growth_rate[0, 0])
        assert exact > 0
        assert found == pytest.approx(exact, rel=1e-12)


def test_cell_counts_at_the_baseline():
    """Counts stated in the project's brief, found there by an independent code."""
    stability = stability_map(BASELINE, ANGLES, ANGLES)
    sliding = quasi_static_map(BASELINE, ANGLES, ANGLES)
    flutter, divergence = (stability.regime_linear.values == kind for kind in (1, 2))
    assert (flutter.sum(), divergence.sum()) == (366, 230)
    unstable = flutter | divergence
    assert not (unstable & sliding.possible_as_printed.values).any()
    assert (flutter & sliding.possible.values).sum() == 366
    assert (divergence & sliding.possible.values).sum() == 0
    pressed = sliding.contact_force_static.values > 0
    assert (~sliding.possible.values & pressed).sum() == 212


def test_flutter_needs_negative_coupling_and_divergence_positive():
    params = UNEQUAL.with_(k1=0.9, mu=0.8)
    regime = stability_map(params, ANGLES, ANGLES).regime_linear.values
    first, second = np.meshgrid(ANGLES, ANGLES, indexing="ij")
    coupling = symbols.function(symbols.STIFFNESS[0, 1])(
        params, alpha1=first, alpha2=second
    )
    for kind, sign in ((1, -1), (2, 1)):
        assert (regime == kind).any()
        assert (sign * coupling[regime == kind] > 0).all()


def test_sigma_matters_only_where_the_contact_law_is_blunt():
    sharp = stability_map(BASELINE, ANGLES[::5], ANGLES[::5])
    steep = stability_map(BASELINE, ANGLES[::5], ANGLES[::5], sigma=1000.0)
    np.testing.assert_allclose(steep.frequency, sharp.frequency, rtol=1e-14)
    blunt = stability_map(BASELINE, ANGLES[::5], ANGLES[::5], sigma=1.2)
    stiffer = BASELINE.with_(k3=BASELINE.k3 * 1.0997817)
    same = stability_map(stiffer, ANGLES[::5], ANGLES[::5])
    np.testing.assert_allclose(blunt.frequency, same.frequency, atol=1e-4)


def test_static_state_at_the_edge_of_contact_and_where_there_is_none():
    """In the scene of Fig. 3, and where both springs are vertical."""
    cell = quasi_static_map(BASELINE, [0.4 * math.pi], [0.6 * math.pi]).isel(
        alpha1=0, alpha2=0
    )
    assert cell.possible
    assert cell.possible_as_printed
    assert float(cell.y_static) == pytest.approx(BASELINE.preload, rel=1e-14)
    assert float(cell.x_static) == pytest.approx(-math.tan(0.4 * math.pi), rel=1e-13)
    assert float(cell.contact_force_static) == 0.0

    cell = quasi_static_map(BASELINE, [math.pi / 2], [math.pi / 2]).isel(
        alpha1=0, alpha2=0
    )
    assert int(cell.outcome) == Outcome.singular_static_state
    assert np.isnan(cell.reaction_force)
    assert not cell.possible | cell.possible_as_printed


def test_frequencies_in_both_states():
    """Largest ω1², rigid modes along α1 + α2 = nπ, and flags for what is no oscillation."""
    result = natural_frequencies(BASELINE, ANGLES, ANGLES)
    first, second = np.meshgrid(np.arange(181), np.arange(181), indexing="ij")
    separated = result.sel(contact_state="separated")
    rigid = separated.outcome.sel(mode=1).values == Outcome.rigid_mode
    np.testing.assert_array_equal(rigid, (first + second) % 180 == 0)
    assert (separated.omega.sel(mode=1).values[rigid] == 0).all()
    np.testing.assert_allclose(
        separated.omega.sel(mode=2).values[rigid], math.sqrt(2), rtol=1e-14
    )
    half = np.isin(first + second, (90, 270))
    np.testing.assert_allclose(separated.omega.values[half], 1.0, rtol=1e-7)
    contact = result.sel(contact_state="contact")
    free = contact.isel(alpha1=90, alpha2=90).sel(mode=1)
    assert int(free.outcome) == Outcome.rigid_mode
    assert float(free.omega) == 0.0
    assert (contact.outcome.sel(mode=1) == Outcome.complex_pair).sum() == 366
    assert (contact.outcome.sel(mode=1) == Outcome.divergence).sum() == 230
    assert (contact.outcome.sel(mode=2) == Outcome.divergence).sum() == 0
    real = contact.outcome.sel(mode=1).values == Outcome.converged
    assert contact.omega.sel(mode=1).values[real].max() ** 2 == pytest.approx(
        1.375, abs=5e-3
    )


@pytest.mark.parametrize("nearby", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_small_separated_frequency_keeps_its_digits(nearby):
    """ω1² = (k/m)(1 − |cos(α1 + α2)|) = 2 (k/m) sin²((α1 + α2)/2) near α1 + α2 = π."""
    first, second = 0.3, math.pi - 0.3 + nearby
    with mpmath.workdps(50):
        total = mpmath.mpf(first) + mpmath.mpf(second)
        exact = float(mpmath.sqrt(1 - abs(mpmath.cos(total))))
    found = natural_frequencies(BASELINE, [first], [second]).isel(alpha1=0, alpha2=0)
    lower = float(found.omega.sel(mode=1, contact_state="separated"))
    assert lower == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize(
    "beyond", [{}, {"mu": 0.05, "k2": 1.7}, {"damping1": 0.2, "damping2": 0.03}]
)
def test_shapes_are_those_of_the_eigenvectors(beyond):
    """The criterion against eigenvectors of the first-order matrix; 0 without any coupling."""
    params = FORMER.with_(**beyond)
    angles = np.linspace(0.1, 3.0, 14)
    found = stability_map(params, angles, angles).shape_similarity.values
    c1, c2 = np.cos(angles[:, None]), np.cos(angles[None, :])
    s1, s2 = np.sin(angles[:, None]), np.sin(angles[None, :])
    for i, j in np.ndindex(found.shape):
        along = np.array([[c1[i, 0], s1[i, 0]], [c2[0, j], -s2[0, j]]])
        stiffness = along.T @ np.diag([params.k1, params.k2]) @ along
        damping = along.T @ np.diag([params.damping1, params.damping2]) @ along
        stiffness += params.k3 * np.array([[0.0, params.mu], [0.0, 1.0]])
        matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]])
        values, vectors = np.linalg.eig(matrix)
        upper = np.argsort(-values.imag)[:2]
        first, second = (vectors[:2, k] / np.linalg.norm(vectors[:2, k]) for k in upper)
        if abs(values[upper[0]] - values[upper[1]]) > 1e-4:
            expected = abs(np.vdot(first, second)) ** 2
            assert found[i, j] == pytest.approx(expected, abs=1e-7), (i, j)
    frictionless = stability_map(
        params.with_(mu=0.0, damping1=0.0, damping2=0.0), angles, angles
    )
    assert not frictionless.shape_similarity.values.any()
