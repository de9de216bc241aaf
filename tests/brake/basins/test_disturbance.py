"""Smallest disturbances: the linear motion in closed form, and what A1 itself does with them."""

import math

import numpy as np
import pytest

from squealpipe import Parameters, simulate, smallest_disturbance
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.dynamics.motion import linear_time
from squealpipe.brake.models.damped import critical_friction
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.schema import Outcome
from tests.former import FORMER

RNG = np.random.default_rng(16)


def random_case(direction):
    """Unequal springs, other units, friction below the onset of flutter."""
    while True:
        k1, k2, k3 = RNG.uniform(0.5, 4.0, 3)
        params = FORMER.with_(
            mass=RNG.uniform(0.5, 3),
            k1=k1,
            k2=k2,
            k3=k3,
            preload=RNG.uniform(0.5, 2),
            belt_speed=direction * RNG.uniform(0.5, 50),
        )
        alpha1, alpha2 = RNG.uniform(0.0, math.pi, 2)
        onset = float(critical_friction(params, alpha1, alpha2)[1])
        params = params.with_(mu=RNG.uniform(0.1, 0.8) * min(onset, 1.0))
        rest = steady_state(params, alpha1, alpha2)
        if abs(math.sin(alpha1 + alpha2)) > 0.2 and rest[1] < 0.8 * params.preload:
            return params, alpha1, alpha2


def contact_matrix(params, alpha1, alpha2):
    k11, k12, k22 = linear_stiffness(params, geometry(alpha1, alpha2))
    drag = math.copysign(params.mu, params.belt_speed)
    return np.array(
        [[k11, k12 + drag * params.k3], [k12, k22 + params.k3]]
    ) / params.mass, drag


def steady_state(params, alpha1, alpha2):
    matrix, drag = contact_matrix(params, alpha1, alpha2)
    return np.linalg.solve(
        matrix, np.array([drag, 1.0]) * params.k3 * params.preload / params.mass
    )


def shortest_by_modes(params, alpha1, alpha2, t_end):
    """min over t of gap/|row of y at t|, from the modes of the 2×2 matrix and nothing else."""
    matrix, _ = contact_matrix(params, alpha1, alpha2)
    squared, shapes = np.linalg.eig(matrix)
    omega = np.sqrt(squared)
    t = np.linspace(0.0, t_end, 200_001)[:, None]
    inverse = np.linalg.inv(shapes)
    by_place = (shapes[1] * np.cos(omega * t)) @ inverse * params.preload
    by_speed = (shapes[1] * np.sin(omega * t) / omega) @ inverse * params.preload
    by_speed /= linear_time(params)
    longest = np.sqrt((by_place**2 + by_speed**2).sum(axis=1)).max()
    return (params.preload - steady_state(params, alpha1, alpha2)[1]) / longest


@pytest.mark.parametrize(
    "direction", [1.0, pytest.param(-1.0, marks=pytest.mark.release)]
)
def test_undamped_linear_sliding_has_a_closed_form(direction):
    """A4 is linear until contact is lost; the search knows nothing of that."""
    for _ in range(2):
        params, alpha1, alpha2 = random_case(direction)
        t_end = 40.0 * linear_time(params)
        found = smallest_disturbance(
            params, alpha1, alpha2, model="A4", t_end=t_end, workers=1
        )
        exact = shortest_by_modes(params, alpha1, alpha2, t_end)
        assert found.outcome == Outcome.converged
        assert float(found.linear_distance) == pytest.approx(exact, rel=1e-6)
        assert exact * (1 - 1e-6) < float(found.distance) < exact * 1.01
        rest = steady_state(params, alpha1, alpha2)
        np.testing.assert_allclose(
            [found.x_rest, found.y_rest], rest, rtol=1e-9, atol=1e-12
        )
        assert (np.diff(found.distance_by_number) <= 0).all()


def state_of(found, params, factor=1.0):
    parts = [float(found[f"{name}_disturbance"]) for name in ("x", "y", "vx", "vy")]
    rest = [float(found.x_rest), float(found.y_rest), 0.0, 0.0]
    return np.add(rest, np.multiply(parts, factor))


@pytest.mark.parametrize(
    "belt_speed", [pytest.param(60.0, marks=pytest.mark.release), -3.0]
)
def test_what_is_found_loses_contact_and_random_smaller_ones_keep_it(belt_speed):
    params = FORMER.with_(
        k2=1.3, length1=4.0, mass=2.0, preload=0.8, belt_speed=belt_speed
    )
    angles = (2.4, 2.5) if belt_speed > 0 else (math.pi - 2.4, math.pi - 2.5)
    found = smallest_disturbance(params, *angles, t_end=60.0, workers=1)
    assert found.outcome == Outcome.converged
    run = simulate(
        params, *angles, t_end=60.0, initial_state=state_of(found, params, 1.0 + 1e-5)
    )
    assert (run.event_kind.values == 0).any()
    size = 400
    z = np.random.default_rng(5).standard_normal((size, 4))
    unit = params.preload * np.array(
        [1.0, 1.0, 1 / linear_time(params), 1 / linear_time(params)]
    )
    z *= 0.97 * float(found.distance) / np.linalg.norm(z, axis=1, keepdims=True)
    rest = state_of(found, params, 0.0)
    runs = run_ensemble(
        params, *angles, t_end=60.0, initial_state=rest + unit * z, workers=1
    )
    assert np.isnan(runs.first_separation_time).all()


def test_the_search_is_that_of_the_mirrored_system():
    """x → −x with the belt reversed; the directions differ, so the search agrees to its error."""
    params = FORMER.with_(mu=0.2, belt_speed=5.0)
    given, image = {"t_end": 60.0, "workers": 1}, params.with_(belt_speed=-5.0)
    one = smallest_disturbance(params, 2.3, 2.45, **given)
    other = smallest_disturbance(image, 2.45, 2.3, seed=2, **given)
    assert float(one.linear_distance) == pytest.approx(
        float(other.linear_distance), rel=1e-9
    )
    assert float(one.distance) == pytest.approx(float(other.distance), rel=0.01)


def test_whirl_is_reached_and_beyond_a_small_bound_not():
    scene = FORMER, 0.75 * math.pi, 0.75 * math.pi
    given = {"leads_to": "whirl", "t_end": 60.0, "workers": 1}
    found = smallest_disturbance(*scene, directions=16, **given)
    assert found.outcome == Outcome.converged
    run = run_ensemble(
        *scene, t_end=60.0, tol=1e-9, initial_state=state_of(found, FORMER)
    )
    assert abs(float(run.turns)) >= 3
    assert 0 < int(found.reached) <= 16
    none = smallest_disturbance(*scene, directions=8, bound=0.4, **given)
    assert none.outcome == Outcome.not_reached
    assert np.isnan(none.distance)
    assert none.reached == 0


def test_unstable_or_no_sliding_is_said_and_nothing_is_run():
    flutter = smallest_disturbance(FORMER.with_(mu=0.9), 0.22, 0.96)
    assert flutter.outcome == Outcome.already_unstable
    assert float(flutter.growth_rate) > 0
    falling = FORMER.with_(
        friction_law="exponential", mu_static=0.6, friction_speed=2.0, belt_speed=2.0
    )
    assert smallest_disturbance(falling, 2.4, 2.5).outcome == Outcome.already_unstable
    damped = falling.with_(damping1=1.0, damping2=1.0)
    assert smallest_disturbance(damped, 2.4, 2.5, t_end=20.0, directions=8).outcome == 0
    for params, angles in (
        (FORMER.with_(belt_speed=0.0), (2.4, 2.5)),
        (FORMER, (0.2 * math.pi, 0.8 * math.pi)),
    ):
        still = smallest_disturbance(params, *angles)
        assert still.outcome == Outcome.no_sliding_state
        assert np.isnan(still.distance)


@pytest.mark.parametrize(
    ("params", "change", "named"),
    [
        (FORMER, {"model": "A1-no-separation"}, "never loses contact"),
        (FORMER, {"model": "A4", "leads_to": "whirl"}, "has no whirl"),
        (FORMER.with_(mu=0.1, damping1=1e8), {}, "shorten t_end, or weaken a dashpot"),
    ],
)
def test_refuses_what_it_cannot_do(params, change, named):
    with pytest.raises(ValueError, match=named):
        smallest_disturbance(params, 2.0, 1.9, **change)


def test_steady_sliding_is_found_in_any_units():
    """Lengths of 1e-9 to 1e9, against the linear state of rest of long springs."""
    for number in range(30):
        params, alpha1, alpha2 = random_case(1 if number % 2 else -1)
        unit = 10.0 ** RNG.uniform(-9, 9)
        params = params.with_(
            mass=params.mass * 1e4,
            preload=params.preload * unit,
            length1=1e6 * unit,
            length2=1e6 * unit,
            belt_speed=params.belt_speed * unit,
        )
        found = Sliding.of(Design(params, alpha1, alpha2))
        assert found is not None
        expected = steady_state(params, alpha1, alpha2)
        np.testing.assert_allclose(
            found.state[:2], expected, atol=1e-3 * np.abs(expected).max()
        )


@pytest.mark.parametrize(
    ("alpha2", "there"),
    [(100.0, (-1.6338058, 0.6388910)), (104.0, (-2.4095261, 0.9428566))],
)
def test_steady_sliding_is_no_saddle_beside_where_raised_friction_leads(alpha2, there):
    """Where an overdamped mass comes to rest by a Runge–Kutta method of its own."""
    found = Sliding.of(Design(Parameters(), *np.radians((72.0, alpha2))))
    np.testing.assert_allclose(found.state[:2], there, atol=1e-7)
    assert np.linalg.det(found.jacobian) > 0.0


@pytest.mark.release
def test_laws_of_the_same_forces_have_the_same_disturbance():
    """Friction and contact as tables of many pieces, or a contact dashpot of size zero."""
    law = FORMER.with_(mu=0.1, damping1=0.05, damping2=0.02, belt_speed=2.0)
    table = law.with_(
        friction_law="linear 0.0:0.1 1.0:0.1 3.0:0.1",
        contact_law=f"linear 0.0:0.0 1.0:{law.k3}",
    )
    expected, *others = (
        smallest_disturbance(p, 2.0, 1.9, directions=16, t_end=50.0, workers=1)
        for p in (law, table, law.with_(contact_law="dashpot"))
    )
    for found in others:
        for name in ("x_rest", "y_rest", "growth_rate", "distance", "linear_distance"):
            np.testing.assert_allclose(
                found[name], expected[name], rtol=1e-6, err_msg=name
            )


def test_where_steady_sliding_lies_in_a_later_piece_of_the_contact_law():
    """Its force balances the springs' there; the first piece alone has another equilibrium."""
    soft = FORMER.with_(mu=0.1, contact_law="linear 0.0:0.0 0.5:0.1 1.0:0.6")
    found = Sliding.of(Design(soft, 2.0, 1.9))
    run = simulate(soft, 2.0, 1.9, t_end=20.0, initial_state=tuple(found.state))
    assert 0.0 < found.state[1] < 1.0
    assert max(np.ptp(run.x.values), np.ptp(run.y.values)) < 1e-9
