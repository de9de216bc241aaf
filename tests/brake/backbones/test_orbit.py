"""Exact periodic motions against values known to 14 digits, independent integration, closed forms
and symmetries."""

import math

import numpy as np
import pytest

from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.models.a4 import first_integral_value
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.schema import Outcome
from tests.former import FORMER
from tests.oracles.a4_scipy import a4_by_scipy

PI = math.pi
BASE = FORMER

KNOWN = [
    (0.5, 1.0, 2, 2.0, 1.23408516277258),
    (1.0, 0.5, 2, 2.0, 1.23408516277258),
    (0.75, 0.75, 2, 2.0, 1.23408516277258),
    (5 / 6, 5 / 6, 1, 2.0, 0.98203370531224),
    (0.3, 0.9, 1, 3.0, 0.58624446384709),
    (0.3, 0.9, 2, 3.0, 1.41139033666343),
    (0.2, 0.7, 1, 6.0, 0.36074585418702),
]
"""Computed independently of this package, to 14 digits: angles over π, mode, y_peak, ω."""


def _orbit(alpha1, alpha2, mode, y_peak, params=BASE):
    return periodic_orbit(params, alpha1 * PI, alpha2 * PI, mode=mode, y_peak=y_peak)


@pytest.mark.parametrize(("alpha1", "alpha2", "mode", "y_peak", "omega"), KNOWN)
def test_known_orbits_are_found_from_cold(alpha1, alpha2, mode, y_peak, omega):
    found = _orbit(alpha1, alpha2, mode, y_peak)
    assert int(found.outcome) == Outcome.converged
    assert float(found.omega) == pytest.approx(omega, abs=1.2e-14)
    assert float(found.residual) <= 1e-14


@pytest.mark.parametrize(("alpha1", "alpha2", "mode", "y_peak", "omega"), KNOWN)
def test_an_independent_integrator_closes_the_orbit(
    alpha1, alpha2, mode, y_peak, omega
):
    angles, found = (alpha1 * PI, alpha2 * PI), _orbit(alpha1, alpha2, mode, y_peak)
    end = 2 * PI / float(found.omega)
    z = a4_by_scipy(BASE, angles, found, end * np.linspace(0, 1, 4001))
    np.testing.assert_allclose(z[:, -1], z[:, 0], atol=2e-8)
    np.testing.assert_allclose(z[2:, 2000], 0.0, atol=2e-8)
    path = a4_by_scipy(BASE, angles, found, np.append(found.time.values, end))[:2, :-1]
    np.testing.assert_allclose([found.x_path, found.y_path], path, atol=2e-8)
    stiffness = linear_stiffness(BASE, geometry(*angles))
    assert np.ptp(first_integral_value(*z, BASE, stiffness)) < 1e-8
    sizes = [found.x_amplitude, found.y_amplitude, found.largest_speed]
    expected = [0.5 * np.ptp(z[0]), 0.5 * np.ptp(z[1]), abs(z[2]).max()]
    np.testing.assert_allclose(sizes, expected, rtol=2e-6)


def test_below_contact_loss_the_orbit_is_the_linear_mode():
    found = _orbit(0.3, 0.9, 1, 0.9)
    assert int(found.outcome) == Outcome.linear_mode
    assert found.sizes["switch"] == 0
    just_beyond = _orbit(0.3, 0.9, 1, 1.0 + 1e-9)
    assert float(just_beyond.omega) == pytest.approx(float(found.omega), abs=1e-8)


def test_a_decoupled_y_motion_tends_to_the_bilinear_oscillator():
    """1/ω = (1/ω_contact + 1/ω_free)/2 in the limit of large amplitudes, from above like 1/y."""
    limit = 2.0 / (1 / math.sqrt(1.75) + 1.0)
    gaps = [
        float(_orbit(0.5, 1.0, 2, peak).omega) - limit for peak in (50.0, 100.0, 200.0)
    ]
    assert gaps[2] < 2e-3
    np.testing.assert_allclose(np.divide(gaps[:-1], gaps[1:]), 2.0, rtol=0.03)


def test_a_coupled_motion_does_not_have_the_bilinear_limit():
    """Quoted in the field as if general: at (0.3π, 0.9π), mode 2, it is 1.420 against 1.385."""
    scene = geometry(0.3 * PI, 0.9 * PI)
    k11, k12, k22 = linear_stiffness(BASE, scene)
    free = math.sqrt(np.linalg.eigvalsh([[k11, k12], [k12, k22]])[1])
    contact = float(_orbit(0.3, 0.9, 2, 0.9).omega)
    bilinear = 2.0 / (1.0 / contact + 1.0 / free)
    assert abs(float(_orbit(0.3, 0.9, 2, 30.0).omega) - bilinear) > 0.02


@pytest.mark.parametrize(
    ("alpha1", "alpha2", "mode", "outcome"),
    [
        (0.5, 1.0, 1, Outcome.isolated_mode),
        (5 / 6, 5 / 6, 2, Outcome.isolated_mode),
        (0.4, 0.6, 1, Outcome.singular_static_state),
        (0.75, 0.85, 1, Outcome.complex_pair),
        (0.44, 0.57, 1, Outcome.divergence),
    ],
)
def test_scenes_without_such_a_motion_say_why(alpha1, alpha2, mode, outcome):
    found = _orbit(alpha1, alpha2, mode, 2.0)
    assert Outcome(int(found.outcome)) == outcome
    assert math.isnan(float(found.x_at_peak))


def test_a_peak_below_the_equilibrium_is_refused():
    with pytest.raises(ValueError, match="equilibrium"):
        _orbit(0.5, 1.0, 2, 0.2)
    for method in ("exact", "hbm"):
        with pytest.raises(ValueError, match=r"y_peak_max = .* peaks above"):
            backbone(FORMER, 0.5 * np.pi, np.pi, mode=2, y_peak_max=0.2, method=method)


def test_a_slow_belt_breaks_the_assumption_and_says_so():
    assert int(_orbit(0.3, 0.9, 1, 3.0).sliding_assumption) == 1
    assert (
        int(_orbit(0.3, 0.9, 1, 3.0, FORMER.with_(belt_speed=0.2)).sliding_assumption)
        == 0
    )


NEAR_FIRST_REST = FORMER.with_(k1=0.975, k2=2.68, k3=0.318, mu=0.85)
NEAR_SECOND_REST = FORMER.with_(k1=2.27, k2=1.717, k3=1.82, mu=0.49)
PEAKS = np.linspace(1.05, 4.0, 15)


@pytest.mark.parametrize(
    ("params", "turn"),
    [
        (NEAR_FIRST_REST, (0.0866, 2.3672, 1)),
        pytest.param(NEAR_FIRST_REST, (1.1, 0.4, 1), marks=pytest.mark.release),
        pytest.param(NEAR_FIRST_REST, (2.6786, 1.8628, 2), marks=pytest.mark.release),
        pytest.param(
            NEAR_SECOND_REST, (1.5464, 1.8739, 1), id="before the second rest"
        ),
    ],
)
@pytest.mark.parametrize(
    "peaks",
    [
        PEAKS[[0, 1, 2, 8, 14]],
        pytest.param(PEAKS[[*range(3, 8), *range(9, 14)]], marks=pytest.mark.release),
    ],
    ids=["few", "others"],
)
def test_extremes_are_those_of_an_integration(params, turn, peaks):
    """Where x turns shortly after or before an instant of rest among them."""
    *angles, mode = turn
    for peak in peaks:
        orbit = periodic_orbit(params, *angles, mode=mode, y_peak=peak)
        if orbit.outcome != Outcome.converged:
            continue
        half = np.linspace(0.0, math.pi / float(orbit.omega), 4001)
        x, y, vx, _ = a4_by_scipy(params, angles, orbit, half)
        found = [orbit.x_amplitude, orbit.y_amplitude, orbit.largest_speed]
        expected = [0.5 * np.ptp(x), 0.5 * np.ptp(y), np.abs(vx).max()]
        np.testing.assert_allclose(found, expected, rtol=2e-6)
