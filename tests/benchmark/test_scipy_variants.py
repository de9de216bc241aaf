"""scipy with a compiled field and with bounded steps: the same solver, asked fairly."""

import numpy as np
import pytest

from squealpipe.benchmark.adapters import solver
from squealpipe.benchmark.problems import Problem, all_data
from squealpipe.benchmark.schema import Reliability
from squealpipe.benchmark.scoring import measure

DATA = {data["name"]: data for data in all_data()}


@pytest.mark.parametrize(
    "name",
    [
        "relief valve",
        pytest.param("A1: hammering", marks=pytest.mark.release),
        "shaken table",
    ],
)
def test_a_compiled_field_takes_the_same_steps(name):
    """Equations with tables of regimes, and with an explicit time: round-off alone differs."""
    plain, compiled = (
        solver(each)(Problem(DATA[name]), 1e-9)
        for each in ("DOP853", "DOP853, compiled field")
    )
    assert plain[1] == compiled[1]
    np.testing.assert_allclose(plain[0], compiled[0], rtol=1e-9)
    np.testing.assert_allclose(plain[2], compiled[2], rtol=1e-6, atol=1e-9)
    assert plain[3] == compiled[3] > 0


def test_bounded_steps_see_two_crossings_that_free_steps_span():
    data = DATA["light barrier"]
    free, bounded = (
        measure(data, solver(name), 1e-10)
        for name in ("DOP853", "DOP853, bounded step")
    )
    assert (free.verdict, free.missed) == (Reliability.silently_wrong, 2)
    assert (bounded.verdict, bounded.missed) == (Reliability.right, 0)
    assert bounded.evaluations > 100 > free.evaluations
