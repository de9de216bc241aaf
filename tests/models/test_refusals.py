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
    {"damping1": 0.1},
    {"damping2": 0.1},
    {"mu_static": 0.5},
    {"friction_law": "exponential"},
    {"friction_law": "hyperbolic", "mu_static": 0.2},
]
LEVELS: dict[str, Callable[[Parameters], object]] = {
    "simulate": lambda p: simulate(p, 1.0, 2.0, t_end=1.0, model="A4"),
    "orbit": lambda p: periodic_orbit(p, 1.0, 2.0, mode=1, y_peak=2.0),
    "exact": lambda p: backbone(p, 1.0, 2.0, mode=1),
    "balance": lambda p: backbone(p, 1.0, 2.0, mode=1, method="hbm"),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("level", LEVELS)
def test_a4_refuses(change, level):
    name, value = next(iter(change.items()))
    with pytest.raises(ValueError, match=rf"{name} = {value!r}.*A4 cannot carry.*use model A1"):
        LEVELS[level](FORMER.with_(**change))


def test_a4_refuses_runs_of_an_ensemble():
    with pytest.raises(ValueError, match="A4 carries no damping"):
        run_ensemble({"damping1": np.array([0.0, 0.1])}, 1.0, 2.0, t_end=1.0, model="A4")


def test_a4_takes_what_changes_nothing():
    plain = simulate(FORMER, 1.0, 2.0, t_end=5.0, model="A4")
    same = simulate(
        FORMER.with_(mu_static=0.3, friction_speed=2.0), 1.0, 2.0, t_end=5.0, model="A4"
    )
    np.testing.assert_array_equal(plain.x, same.x)


def test_inference_is_of_the_papers_friction():
    with pytest.raises(ValueError, match=r"damping1 = 0\.1: infer_parameters cannot carry"):
        infer_parameters(FORMER.with_(damping1=0.1), samples=16)


def test_the_linear_motion_of_the_paper_has_neither_damping_nor_another_law():
    for change in CHANGES:
        with pytest.raises(ValueError, match=r"linear_pull_map cannot carry"):
            linear_pull_map(FORMER.with_(**change), [1.0], [2.0])
