"""What the levels know of a contact law, its slope and its dashpot, and what they refuse."""

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest

from squealpipe import (
    Parameters,
    backbone,
    critical_friction_map,
    periodic_orbit,
    quasi_static_map,
    simulate,
    stability_map,
)
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.assumptions import linear_pull_map
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.paper.inference.inference import infer_parameters
from tests.former import FORMER
from tests.systems.test_own_laws import PAD, SOFTENING

ANGLES = np.array([0.4, 1.9]), np.array([0.7, 2.6])


@pytest.mark.parametrize(
    "laws",
    [
        {"contact_law": SOFTENING},
        {"k3": 7e6, "contact_law": "dashpot", "damping3": 400.0},
    ],
)
def test_growth_rates_are_those_of_the_matrix(laws):
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, **laws)
    k3 = params.k3 if "damping3" in laws else 6e6  # of the table: 120 N over 2e-5 m
    c3, mu, mass = params.damping3, params.mu, params.mass
    found = stability_map(params, *ANGLES)
    for angles, rate in zip(
        product(*ANGLES), found.growth_rate.values.ravel(), strict=True
    ):
        k11, k12, k22 = linear_stiffness(params, geometry(*angles))
        stiffness = np.array([[k11, k12 + mu * k3], [k12, k22 + k3]])
        damping = np.array([[0.0, mu * c3], [0.0, c3]])
        matrix = np.block(
            [[np.zeros((2, 2)), np.eye(2)], [-stiffness / mass, -damping / mass]]
        )
        expected = np.linalg.eigvals(matrix).real.max()
        assert abs(rate - expected) < 1e-7 * np.sqrt(params.k1 / mass)


def test_static_states_have_the_force_of_the_table():
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, contact_law=SOFTENING)
    assert params.k3 * params.preload == pytest.approx(
        80.0, rel=1e-15
    )  # halfway from 20 to 140 N
    state = quasi_static_map(params, *ANGLES)
    force = 80.0 - 6e6 * state.y_static
    np.testing.assert_allclose(state.contact_force_static, force, rtol=1e-12)


def test_levels_that_cannot_carry_a_contact_law_say_so():
    params = Parameters(**PAD, belt_speed=2.0, mu=0.4, contact_law=SOFTENING)
    with pytest.raises(
        ValueError, match="critical friction is that of the linear contact"
    ):
        critical_friction_map(params, *ANGLES)
    with pytest.raises(ValueError, match="regularizes the linear contact law alone"):
        stability_map(params, *ANGLES, sigma=1e3)


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
def test_a4_and_the_linear_motion_refuse(change):
    name, value = next(iter(change.items()))
    for level in LEVELS.values():
        with pytest.raises(
            ValueError, match=rf"{name} = {value!r}.*A4 cannot carry.*use model A1"
        ):
            level(FORMER.with_(**change))
    with pytest.raises(ValueError, match=r"linear_pull_map cannot carry"):
        linear_pull_map(FORMER.with_(**change), [1.0], [2.0])


def test_ensembles_of_a4_and_inference_refuse_too():
    with pytest.raises(ValueError, match="A4 carries no damping"):
        run_ensemble(
            {"damping1": np.array([0.0, 0.1])}, 1.0, 2.0, t_end=1.0, model="A4"
        )
    with pytest.raises(
        ValueError, match=r"damping1 = 0\.1: infer_parameters cannot carry"
    ):
        infer_parameters(FORMER.with_(damping1=0.1), samples=16)


def test_a4_takes_what_changes_nothing():
    same = FORMER.with_(mu_static=0.3, friction_speed=2.0)
    runs = [
        simulate(params, 1.0, 2.0, t_end=5.0, model="A4") for params in (FORMER, same)
    ]
    np.testing.assert_array_equal(runs[0].x, runs[1].x)
