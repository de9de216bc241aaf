"""The first root of a step's polynomial: known roots, grazing pairs, near misses."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest

from squealpipe.systems.taylor.kernels import Kernels
from squealpipe.systems.taylor.roots import first_root, root_search

ORDER, STEP = 15, 0.7


@Kernels(Path(__file__).parent)
def _first(coefficients: Annotated[Any, np.dtype(float), 3], step: float) -> float:
    return first_root(coefficients, 0, 0, step)[0]


def found(polynomial, step=STEP):
    coefficients = np.zeros((1, ORDER + 1, 1))
    values = np.atleast_1d(polynomial.convert().coef)
    coefficients[0, : values.size, 0] = values
    return _first(coefficients, step)


def test_first_of_many_known_roots():
    rng = np.random.default_rng(1)
    for _ in range(150):
        roots = rng.uniform(-2.0, 2.0, rng.integers(1, 10))
        polynomial = np.polynomial.Polynomial.fromroots(roots) * rng.choice([-1.0, 1.0])
        inside = np.sort(roots[(roots > 0) & (roots <= STEP)])
        if np.any(np.diff(np.sort(roots)) < 1e-3) or np.any(
            np.abs(roots - STEP) < 1e-9
        ):
            continue
        expected = inside[0] if inside.size else root_search.no_root
        assert found(polynomial) == pytest.approx(expected, abs=1e-11)


def test_a_start_on_the_surface_is_no_root():
    for slope in (1e-12, 1.0, -1.0):
        assert (
            found(np.polynomial.Polynomial([0.0, slope, 0.1 * slope]))
            == root_search.no_root
        )
    assert found(np.polynomial.Polynomial([0.0, -0.3, 1.0])) == pytest.approx(
        0.3, abs=1e-15
    )


def test_a_root_at_the_end_counts():
    assert found(np.polynomial.Polynomial([-0.5, 1.0]), 0.5) == 0.5
    assert (
        found(np.polynomial.Polynomial([-0.5, 1.0]), np.nextafter(0.5, 0.0))
        == root_search.no_root
    )


@pytest.mark.parametrize("root", [0.2, 0.35, 0.6])
def test_a_root_that_round_off_hides_is_one_if_the_other_side_follows(root):
    """(x − r)⁵ multiplied out is round-off next to r, where it changes its sign, (x − r)⁶ not."""
    odd, even = (np.polynomial.Polynomial.fromroots([root] * count) for count in (5, 6))
    assert found(odd) == pytest.approx(root, abs=2e-3)
    assert found(even) == root_search.no_root
