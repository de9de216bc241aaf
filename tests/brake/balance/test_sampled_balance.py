"""The paper's own harmonic balance: its matrices, its Jacobian and what it gets wrong."""

import math
from functools import partial

import numpy as np

from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.balance.harmonic_balance import cosines_of
from squealpipe.brake.balance.sampled_balance import (
    SampledBalance,
    derivative_matrix,
    fourier_matrix,
)
from squealpipe.brake.orbits.orbit_shape import sample
from tests.former import FORMER
from tests.oracles.differences import assert_jacobian


def _started(peak, n_time):
    scene = scaled_system(FORMER, 0.3 * math.pi, 0.9 * math.pi)
    orbit, _ = find_orbit(scene, 1, peak)
    states = sample(scene.system.rows, orbit.point, np.linspace(0, math.pi, 2049))
    balance = SampledBalance(scene.system, 8, n_time, 1e3)
    cosines = cosines_of(states[:, 0]), cosines_of(states[:, 1])
    return balance, partial(balance.start_from_cosines, *cosines, orbit.omega)


def test_derivative_matrix_differentiates_the_fourier_matrix():
    coefficients = np.random.default_rng(1).normal(size=9)
    theta, step = 2 * math.pi * np.arange(40) / 40, 1e-6
    order = np.arange(1, 5)

    def series(angle):
        waves = np.stack(
            [np.sin(np.outer(angle, order)), np.cos(np.outer(angle, order))], axis=2
        )
        return coefficients[0] + waves.reshape(40, 8) @ coefficients[1:]

    slope = fourier_matrix(4, 40) @ derivative_matrix(4) @ coefficients
    expected = (series(theta + step) - series(theta - step)) / (2 * step)
    np.testing.assert_allclose(slope, expected, atol=1e-8)


def test_two_n_harmonics_samples_lack_a_rank():
    """E6: at N = 2 N_h the column sin(N_h θ) vanishes."""
    assert np.linalg.matrix_rank(fourier_matrix(8, 16)) == 16
    assert np.linalg.matrix_rank(fourier_matrix(8, 17)) == 17


def test_jacobian_is_rectangular_and_agrees_with_differences():
    """E7: one unknown more than equations."""
    balance, started = _started(2.0, 64)
    smooth, start = SampledBalance(balance.system, 8, 64, 20.0), started()
    assert smooth.evaluate(start)[1].shape == (34, 35)
    assert_jacobian(smooth.evaluate, start, atol=1e-6)


def test_without_a_phase_condition_the_answer_depends_on_the_phase():
    """E7: with few samples the largest y moves with the phase of the start; with many it stays."""
    spreads = []
    for n_time in (18, 512):
        balance, started = _started(3.0, n_time)
        found = [
            balance.solve(started(phase)) for phase in 2 * math.pi * np.arange(7) / 7
        ]
        assert all(solution.converged for solution in found)
        peaks = [balance.peak(solution) for solution in found]
        spreads.append(max(peaks) - min(peaks))
    assert spreads[0] > 1e-2
    assert spreads[1] < 0.2 * spreads[0]
