"""Dashpots and friction laws in the engine: against long double, limits, growth."""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.codes import Event
from squealpipe.laws.friction_laws import LAWS
from tests.former import FORMER
from tests.oracles.a1_long_double import simulate_reference


def random_cases(count, seed, **fixed):
    """Unequal springs, both belt directions, slow and fast, other units, any start."""
    rng = np.random.default_rng(seed)
    cases = []
    for _ in range(count):
        mass, k1, length = np.exp(rng.uniform(-3, 3, 3))
        unit = np.sqrt(mass / k1)
        (c1, c2), mu = (
            rng.choice([0.0, 0.02, 0.5], 2) * k1 * unit,
            rng.uniform(0.0, 0.6),
        )
        k2, k3 = k1 * rng.uniform(0.3, 3, 2)
        speed = rng.choice([-1, 1]) * rng.uniform(0.05, 1.0) * length / unit
        length1, length2 = length * rng.uniform(2, 8, 2)
        params = FORMER.with_(
            mass=mass,
            k1=k1,
            k2=k2,
            k3=k3,
            mu=mu,
            belt_speed=speed,
            preload=length,
            length1=length1,
            length2=length2,
            damping1=c1,
            damping2=c2,
            friction_law=str(rng.choice(list(LAWS))),
            mu_static=mu + rng.uniform(0.0, 0.6),
            friction_speed=rng.uniform(0.05, 2.0) * length / unit,
        )
        start = rng.uniform(-0.5, 0.5, 4) * [
            length,
            length,
            length / unit,
            length / unit,
        ]
        alpha1, alpha2 = rng.uniform(0, np.pi, 2)
        cases.append((params.with_(**fixed), alpha1, alpha2, tuple(start.tolist())))
    return cases


def scale_of(params):
    """Units of a state."""
    return params.preload / np.array([1.0, 1.0, params.time_unit, params.time_unit])


@pytest.mark.release
@pytest.mark.parametrize("law", LAWS)
def test_runs_agree_with_long_double(law):
    """States, regimes and event times, through slip, stick, release, flight and contact."""
    seen: set[int] = set()
    for params, alpha1, alpha2, start in random_cases(12, seed=31, friction_law=law):
        t_end = 12.0 * params.time_unit
        run = run_ensemble(
            params, alpha1, alpha2, t_end=t_end, initial_state=start, log_events=99
        )
        exact = simulate_reference(
            params, alpha1, alpha2, t_end=t_end, initial_state=start
        )
        assert exact.message == ""
        times = run.event_times[np.isfinite(run.event_times)]
        assert len(times) == len(exact.event_times)
        apart = (times - np.float64(exact.event_times)) / params.time_unit
        np.testing.assert_allclose(apart, 0.0, atol=1e-9)
        apart = (run.final_state - np.float64(exact.state)) / scale_of(params)
        np.testing.assert_allclose(apart, 0.0, atol=1e-9)
        seen |= set(run.event_kinds[: len(times)].tolist())
    assert seen == set(map(int, Event))


def test_mixed_runs_equal_those_alone():
    """Runs of several systems in one call: each is what it is alone, bit for bit."""
    mixed = {
        "friction_law": np.array(["coulomb", "exponential", "hyperbolic", "coulomb"]),
        "damping1": np.array([0.0, 0.1, 0.0, 0.2]),
        "mu_static": np.array([0.3, 0.6, 0.6, 0.5]),
        "belt_speed": 0.5,
    }
    whole = run_ensemble(mixed, 1.0, 2.2, t_end=20.0, log_events=20)
    assert whole.outcome.shape == (4,)
    for row in range(4):
        one = {
            name: np.ravel(value)[row % np.size(value)] for name, value in mixed.items()
        }
        one["friction_law"] = str(one["friction_law"])
        alone = run_ensemble(one, 1.0, 2.2, t_end=20.0, log_events=20)
        for name, (values,) in alone._raw.items():
            np.testing.assert_array_equal(whole._raw[name][row], values, err_msg=name)


@pytest.mark.parametrize(
    "law",
    [
        pytest.param(law, marks=[pytest.mark.release] * (law != "exponential"))
        for law in LAWS
    ],
)
def test_growth_of_a_perturbation_is_that_of_a_nearby_run(law):
    """The variational equations, velocity derivatives and saltations included.

    The tangent starts along (1, 1, 1, 1)/2 in units of l_pre and √(m/k1); a central difference
    of two runs whose events are the same has grown as much.
    """
    compared = stuck = 0
    for params, alpha1, alpha2, start in random_cases(24, seed=37, friction_law=law):
        t_end, step = 9.0 * params.time_unit, 1e-6
        scale = scale_of(params)
        low, run, high = (
            run_ensemble(
                params,
                alpha1,
                alpha2,
                t_end=t_end,
                log_events=60,
                tangent=True,
                initial_state=start + side * 0.5 * step * scale,
            )
            for side in (-1, 0, 1)
        )
        if (
            not low.event_kinds.tolist()
            == run.event_kinds.tolist()
            == high.event_kinds.tolist()
        ):
            continue
        growth = np.linalg.norm((high.final_state - low.final_state) / scale) / (
            2 * step
        )
        if growth < 1e-6:
            continue
        assert run.log_growth == pytest.approx(np.log(growth), abs=2e-4)
        compared += 1
        stuck += int(run.slips) > 0
    assert compared >= 16
    assert stuck >= 6


@pytest.mark.parametrize(("length1", "length2"), [(1e7, 1e7), (1e6, 4.0)])
def test_very_long_springs_keep_their_digits(length1, length2):
    """Against long double, whose own loss is 1e-12 at these lengths; it was 2e-8."""
    for params, alpha1, alpha2, _ in random_cases(2, seed=39, friction_law="coulomb"):
        plain = FORMER.with_(
            k2=params.k2 / params.k1,
            mu=params.mu,
            belt_speed=0.7,
            length1=length1,
            length2=length2,
        )
        run = run_ensemble(plain, alpha1, alpha2, t_end=5.0, log_events=9)
        exact = simulate_reference(plain, alpha1, alpha2, t_end=5.0)
        assert len(exact.event_times) == int((run.event_kinds >= 0).sum())
        np.testing.assert_allclose(run.final_state, np.float64(exact.state), atol=3e-11)
