"""Sobol indices: how often their 95 % intervals hold the closed form."""

import math

import numpy as np
import pytest
from scipy.stats import binomtest

from squealpipe.vibration.shares import wilson_interval
from squealpipe.vibration.sobol import (
    SobolRules,
    saltelli_matrices,
    scrambled,
    share_interval,
    sobol_indices,
)


def ishigami(u):
    """sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 on (−π, π)³, with first-order and total indices."""
    x1, x2, x3 = math.pi * (2.0 * u - 1.0)
    return np.sin(x1) + 7.0 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def ishigami_indices():
    alone = np.array([0.5 * (1.0 + 0.1 * math.pi**4 / 5.0) ** 2, 7.0**2 / 8.0, 0.0])
    with_third = 0.1**2 * math.pi**8 * 8.0 / 225.0
    both = np.array([alone, alone + np.array([with_third, 0.0, with_third])])
    return both / (alone.sum() + with_third)


WEIGHTS = np.array([0.0, 1.0, 4.5, 9.0])


def g_function(u):
    """Π (|4u − 2| + a)/(1 + a)."""
    return np.prod((abs(4.0 * u.T - 2.0) + WEIGHTS) / (1.0 + WEIGHTS), axis=1)


def g_indices():
    alone = 1.0 / (3.0 * (1.0 + WEIGHTS) ** 2)
    whole = np.prod(1.0 + alone)
    return np.array([alone, alone * whole / (1.0 + alone)]) / (whole - 1.0)


def inside(u):
    """[u1 < 0.6][u2 < 0.45], u3 idle: a verdict, as propensities are."""
    return ((u[0] < 0.6) & (u[1] < 0.45)).astype(float)


def inside_indices():
    a, b = 0.6, 0.45
    first = np.array([b * b * a * (1 - a), a * a * b * (1 - b), 0.0]) / (
        a * b * (1 - a * b)
    )
    return np.array([first, [1.0 - first[1], 1.0 - first[0], 0.0]])


@pytest.mark.parametrize(
    ("function", "exact"),
    [
        (ishigami, ishigami_indices()),
        pytest.param(g_function, g_indices(), marks=pytest.mark.release),
        (inside, inside_indices()),
    ],
)
def test_intervals_hold_the_closed_form_as_often_as_they_claim(function, exact):
    """95 % both ways: intervals of independent points hold it always (99.5 to 100 %)."""
    inputs, held, halves = exact.shape[1], [], []
    for seed in range(60):
        values = np.array([function(u) for u in saltelli_matrices(inputs, 1024, seed)])
        found, half = sobol_indices(
            values.reshape(2 + inputs, SobolRules.replicates, -1)
        )
        held.append(abs(found - exact) <= half)
        halves.append(half)
    idle = exact[1] == 0.0  # its total index and interval are exactly 0
    share = np.mean(held, axis=0)
    assert share[:, idle].min(initial=1.0) > 0.9
    assert 0.92 < share[:, ~idle].mean() < 0.98
    assert np.mean(halves) < 0.05


@pytest.mark.parametrize(
    ("corner", "most"),
    [
        pytest.param((0.6, 0.45), 0.985, marks=pytest.mark.release),
        ((0.5, 0.4, 0.3), 0.985),
        pytest.param((0.3,), 1, marks=pytest.mark.release),
    ],
)
def test_intervals_of_shares_hold_them_as_often_as_they_claim(corner, most):
    """[u < corner] with two idle inputs; Wilson's intervals hold it always, and are wider."""
    ends = []
    for seed in range(200):
        happens = (
            scrambled(len(corner) + 2, 1024, seed)[:, : len(corner)] < corner
        ).all(axis=1)
        ends.append(
            (*share_interval(happens), *wilson_interval(int(happens.sum()), 1024))
        )
    low, high, wilson_low, wilson_high = np.transpose(ends)
    exact = np.prod(corner)
    assert 0.92 < np.mean((low < exact) & (exact < high)) <= most
    assert np.mean(high - low) < 0.7 * np.mean(wilson_high - wilson_low)


@pytest.mark.parametrize(("count", "size"), [(0, 7), (3, 8), (50, 1000), (9, 9)])
def test_wilsons_interval_is_that_of_scipy(count, size):
    """scipy.stats takes a second to import, so ours stands in its place."""
    exact = binomtest(count, size).proportion_ci(0.95, method="wilson")
    assert wilson_interval(count, size) == pytest.approx(exact, abs=1e-12)


def test_rare_shares_have_an_interval_of_some_width():
    assert share_interval(np.zeros(64, dtype=bool)) == wilson_interval(0, 64)


def test_one_quantity_in_other_units_has_the_same_indices():
    values = np.array([ishigami(u) for u in saltelli_matrices(3, 256, 7)])
    values = values.reshape(5, SobolRules.replicates, -1)
    for one, other in zip(
        sobol_indices(values), sobol_indices(1e7 * values - 3e8), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)
