"""A4, its orbits and the balances refuse what would break their first integral."""

from collections.abc import Callable

import numpy as np
import pytest

from squealpipe import backbone, periodic_orbit, simulate
from squealpipe.parameters import Parameters
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.dynamics.assumptions import linear_pull_map
from squealpipe.tasks.inference.inference import infer_parameters
from tests.former import FORMER

CHANGES = [
    {"damping1": 0.1}, {"damping2": 0.1}, {"mu_static": 0.5}, {"friction_law": "exponential"},
    {"friction_law": "hyperbolic", "mu_static": 0.2},
]  # fmt: skip
LEVELS: dict[str, Callable[[Parameters], object]] = {
    "simulate": lambda p: simulate(p, 1.0, 2.0, t_end=1.0, model="A4"),
    "orbit": lambda p: periodic_orbit(p, 1.0, 2.0, mode=1, y_peak=2.0),
    "exact": lambda p: backbone(p, 1.0, 2.0, mode=1),
    "balance": lambda p: backbone(p, 1.0, 2.0, mode=1, method="hbm"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a4_and_the_linear_motion_refuse(change):
    name, value = next(iter(change.items()))
    for level in LEVELS.values():
        with pytest.raises(ValueError, match=rf"{name} = {value!r}.*A4 cannot carry.*use model A1"):
            level(FORMER.with_(**change))
    with pytest.raises(ValueError, match=r"linear_pull_map cannot carry"):
        linear_pull_map(FORMER.with_(**change), [1.0], [2.0])


def test_ensembles_of_a4_and_inference_refuse_too():
    with pytest.raises(ValueError, match="A4 carries no damping"):
        run_ensemble({"damping1": np.array([0.0, 0.1])}, 1.0, 2.0, t_end=1.0, model="A4")
    with pytest.raises(ValueError, match=r"damping1 = 0\.1: infer_parameters cannot carry"):
        infer_parameters(FORMER.with_(damping1=0.1), samples=16)


def test_a4_takes_what_changes_nothing():
    same = FORMER.with_(mu_static=0.3, friction_speed=2.0)
    runs = [simulate(params, 1.0, 2.0, t_end=5.0, model="A4") for params in (FORMER, same)]
    np.testing.assert_array_equal(runs[0].x, runs[1].x)
