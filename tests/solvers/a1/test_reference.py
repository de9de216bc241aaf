"""The long-double reference against scipy, which shares no integrator with it."""

import numpy as np
import pytest

from squealpipe.models.a1_automaton import EventKind
from squealpipe.solvers.a1.peers import simulate_moreau_jean, simulate_regularized, simulate_scipy
from squealpipe.solvers.a1.reference import simulate_reference
from squealpipe.tasks.comparison.work_precision.integration import SCENES
from tests.former import FORMER


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_reference_agrees_with_scipy_at_its_limit(scene) -> None:
    arguments = scene.arguments(FORMER)
    found = simulate_reference(**arguments, t_end=30.0)
    public = simulate_scipy(**arguments, t_end=30.0, tol=1e-13)
    assert found.message == ""
    assert found.event_kinds == public.event_kinds
    assert found.regimes == public.regimes
    np.testing.assert_allclose(
        np.array(public.event_times), np.float64(found.event_times), atol=1e-9
    )
    np.testing.assert_allclose(public.state, np.float64(found.state), atol=1e-10)


def test_reference_is_long_double() -> None:
    """At rest from y = 0 the first separation has a closed form for K = diag(k, k), L → ∞."""
    run = simulate_reference(
        FORMER.with_(k3=2.0, mu=0.0, length1=1e12, length2=1e12),
        np.pi / 2, np.pi, t_end=5.0, stop_at=EventKind.separation,
    )  # fmt: skip
    assert run.state.dtype == np.longdouble
    assert float(run.event_times[0]) == pytest.approx(np.arccos(-0.5) / np.sqrt(3.0), abs=1e-6)


@pytest.mark.parametrize(("initial", "first"), [((0, 1, 0, 0.5), 3), ((0, 1, 0, -0.5), 0)])
def test_a_start_on_the_threshold_goes_where_its_velocity_points(initial, first) -> None:
    params = FORMER
    for run in (
        simulate_reference(params, 0.9, 2.0, t_end=3.0, initial_state=initial),
        simulate_scipy(params, 0.9, 2.0, t_end=3.0, tol=1e-10, initial_state=initial),
    ):
        assert run.regimes[0] == first


def test_regularized_laws_tend_to_the_sharp_ones() -> None:
    scene = SCENES[2]
    arguments = scene.arguments(FORMER)
    sharp = simulate_reference(**arguments, t_end=10.0)
    errors = [
        np.abs(
            simulate_regularized(**arguments, t_end=10.0, sigma=sigma, tol=1e-9).state
            - np.float64(sharp.state)
        ).max()
        for sigma in (10.0, 100.0, 1000.0)
    ]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 5e-3


def test_moreau_jean_tends_to_the_reference_with_its_step() -> None:
    scene = SCENES[1]
    arguments = scene.arguments(FORMER)
    sharp = simulate_reference(**arguments, t_end=10.0)
    errors = [
        np.abs(
            simulate_moreau_jean(**arguments, t_end=10.0, step=step).state - np.float64(sharp.state)
        ).max()
        for step in (1e-2, 1e-3)
    ]
    assert errors[1] < 0.1 * errors[0] < 1e-4
