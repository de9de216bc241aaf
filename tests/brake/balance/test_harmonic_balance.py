"""Harmonic balance in cosines: derivatives, order of convergence, symmetry of the description."""

import math

import numpy as np
import pytest

from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.balance.harmonic_balance import (
    CosineBalance,
    contact_of,
    cosines_of,
    series_extremes,
    series_speed,
)
from squealpipe.brake.orbits.orbit_shape import sample
from tests.former import FORMER
from tests.oracles.differences import assert_jacobian

ANGLES = (0.3 * math.pi, 0.9 * math.pi)


def _exact(peak, mode=1):
    scene = scaled_system(FORMER, *ANGLES)
    orbit, _ = find_orbit(scene, mode, peak)
    states = sample(scene.system.rows, orbit.point, np.linspace(0, math.pi, 2**14 + 1))
    return scene, orbit, cosines_of(states[:, 0]), cosines_of(states[:, 1])


@pytest.mark.parametrize(("n_time", "sigma"), [(None, None), (400, 30.0)])
def test_jacobian_agrees_with_differences(n_time, sigma):
    scene, orbit, x, y = _exact(2.0)
    balance = CosineBalance(scene.system, contact_of(6, n_time, sigma))
    z = np.concatenate([x[:7], y[:7], [orbit.omega]]) + 0.01
    assert_jacobian(balance.evaluate, z, atol=1e-7)


def test_omega_converges_with_the_fourth_power_and_keeps_the_goals():
    """The goals of the project: N_h = 32 to 1e-7, N_h = 64 to 1e-8 at equal peak; 1e-10 at
    equal first harmonic."""
    peaks = (1.25, 2.0, 2.75, 3.5)
    exact = [_exact(peak) for peak in peaks]
    worst = {}
    for count in (8, 16, 32, 64):
        errors = []
        for peak, (scene, orbit, x, y) in zip(peaks, exact, strict=True):
            balance = CosineBalance(scene.system, contact_of(count, None, None))
            guess = np.concatenate([x[: count + 1], y[: count + 1], [orbit.omega]])
            same_peak = balance.solve(guess, balance.peak_row, peak)
            first_harmonic = np.eye(2 * count + 3)[count + 2]
            same_first = balance.solve(guess, first_harmonic, float(y[1]))
            found = np.array([same_peak[0][-1], same_first[0][-1]])
            errors.append(np.abs(found - orbit.omega) * scene.frequency)
        worst[count] = np.max(errors, axis=0)
    assert worst[32][0] <= 1e-7
    assert (worst[64] <= [1e-8, 1e-10]).all()
    rate = np.polyfit(
        np.log(list(worst)), np.log([value[0] for value in worst.values()]), 1
    )[0]
    assert -4.8 < rate < -3.4


@pytest.mark.parametrize(("peak", "rate"), [(1.0, 1.5), (2.0, 2.0)])
def test_smoothing_shifts_omega_by_a_power_of_sigma(peak, rate):
    """σ⁻², at grazing σ^-1.5; at equal harmonics, so that truncation cancels."""
    scene, orbit, x, y = _exact(peak)
    guess = np.concatenate([x[:33], y[:33], [orbit.omega]])
    omegas = []
    for sigma in (None, 100.0, 1000.0):
        balance = CosineBalance(scene.system, contact_of(32, None, sigma))
        omegas.append(balance.solve(guess, balance.peak_row, peak)[0][-1])
    sharp, first, second = omegas
    assert math.log10(abs(first - sharp) / abs(second - sharp)) == pytest.approx(
        rate, abs=0.1
    )


def test_a_motion_described_from_its_other_end_solves_the_equations_too():
    scene, orbit, x, y = _exact(2.0)
    balance = CosineBalance(scene.system, contact_of(12, None, None))
    guess = np.concatenate([x[:13], y[:13], [orbit.omega]])
    solution, _ = balance.solve(guess, balance.peak_row, 2.0)
    values, _ = balance.evaluate(balance.shift_signs * solution)
    assert np.abs(values).max() < 1e-12


def test_linear_motion_in_contact_is_exact_with_one_harmonic():
    scene = scaled_system(FORMER, *ANGLES)
    balance = CosineBalance(scene.system, contact_of(1, None, None))
    amplitude = 0.5 * (1.0 - scene.rest[1])
    x, y = (scene.rest[0], scene.slope(1) * amplitude), (scene.rest[1], amplitude)
    assert np.abs(balance.evaluate(np.array([*x, *y, scene.omega(1)]))[0]).max() < 1e-15


def test_extremes_and_speed_of_a_series_known_in_closed_form():
    series = np.array([[0.7, 2.0, 0.0], [0.0, 0.0, 1.5]])
    np.testing.assert_allclose(series_extremes(series), [2.0, 1.5], rtol=1e-9)
    np.testing.assert_allclose(series_speed(series), [2.0, 3.0], rtol=1e-3)
