"""simulate, validity_map, hammering_map, refine_validity_map as users and rules call them."""

import re

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.dynamics.whirl import transient_lifetimes, whirl_sizes
from squealpipe.codes import Regime
from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome
from squealpipe.store import load, save
from tests.former import FORMER

BASELINE = FORMER
SLOW = FORMER.with_(belt_speed=0.3)
ANGLES = np.linspace(0, np.pi, 13)


def test_state_at_exactly_the_asked_instants():
    times = np.array([0.0, 0.1, 1 / 3, 7.0, 20.0])
    few = simulate(SLOW, 0.7, 2.0, t_end=20.0, times=times)
    np.testing.assert_array_equal(few.time, times)
    many = simulate(
        SLOW, 0.7, 2.0, t_end=20.0, times=np.union1d(times, np.linspace(0, 20, 301))
    )
    for name in ("x", "y", "vx", "vy", "normal_force", "regime"):
        np.testing.assert_array_equal(few[name], many[name].sel(time=times))


def test_growth_of_a_run_that_overflows_is_not_a_number():
    run = simulate(
        BASELINE, 1.0, 1.2, t_end=5.0, initial_state=(1e200, 0, 0, 0), growth=True
    )
    assert run.outcome == Outcome.not_finite
    assert np.isnan(run.growth)


def test_force_and_regimes_agree():
    run = simulate(SLOW, 0.35 * np.pi, 0.75 * np.pi, t_end=60.0)
    free = run.regime.values == Regime.separated
    assert 0 < np.count_nonzero(free) < free.size
    expected = np.where(free, 0.0, 0.75 * (1 - run.y))
    np.testing.assert_allclose(run.normal_force, expected, rtol=1e-12)
    sign = np.sign(0.3 - run.vx.values)
    for regime, side in (
        (Regime.stick, 0),
        (Regime.slip_slower, 1),
        (Regime.slip_faster, -1),
    ):
        assert (sign[run.regime.values == regime] == side).all()


def test_runs_with_no_event_and_with_more_than_the_first_log_holds():
    run = simulate(BASELINE, 0.5 * np.pi, np.pi, t_end=20.0)
    assert (run.event_time.size, run.outcome) == (0, Outcome.converged)
    run = simulate(SLOW, 0.0, 0.0, t_end=9000.0, times=[0.0])
    assert run.event_time.size > 1024
    assert (np.diff(run.event_time) >= 0).all()


@pytest.mark.parametrize("model", ["A1", "A1-no-separation", "A1-linear-springs", "A4"])
def test_models_differ_as_they_should(model):
    run = simulate(BASELINE, 0.9 * np.pi, 0.95 * np.pi, t_end=30.0, model=model)
    assert run.attrs["model"] == model
    assert run.outcome == Outcome.converged
    assert (run.normal_force.values < 0).any() == (model == "A1-no-separation")


def test_validity_map_agrees_with_single_runs():
    result = validity_map(BASELINE, ANGLES, ANGLES, t_end=60.0)
    for i, j in ((0, 0), (3, 5), (6, 2), (12, 7), (5, 11)):
        run = simulate(BASELINE, ANGLES[i], ANGLES[j], t_end=60.0)
        lost = run.event_time.values[run.event_kind.values == 0]
        cell = result.isel(alpha1=i, alpha2=j)
        assert bool(cell.separates) == bool(lost.size)
        if lost.size:
            assert cell.first_separation_time == lost[0]
            assert np.isnan(cell.response_growth)
    assert set(np.unique(result.outcome)) == {Outcome.converged, Outcome.separated}


def test_hammering_map_agrees_with_single_runs(tmp_path):
    result = hammering_map(SLOW, ANGLES, ANGLES, t_end=60.0)
    for i, j in ((0, 0), (3, 9), (6, 2), (12, 7)):
        run = simulate(
            SLOW, ANGLES[i], ANGLES[j], t_end=60.0, times=np.linspace(0, 60, 20_001)
        )
        cell = result.isel(alpha1=i, alpha2=j)
        kinds = run.event_kind.values
        assert float(cell.impact_rate) == np.count_nonzero(kinds == 1) / 60.0
        shares = [
            (run.regime == each).mean() for each in (Regime.separated, Regime.stick)
        ]
        found = cell.separated_fraction, cell.stick_fraction
        np.testing.assert_allclose(found, shares, atol=2e-3)
        largest = run.normalized_contact_force.max(), np.hypot(run.x, run.y).max()
        found = cell.peak_contact_force, cell.max_displacement
        np.testing.assert_allclose(found, largest, rtol=0, atol=1e-5)
    path = save(result, tmp_path / "map.nc")
    assert load(path).equals(result)


def test_horizon_follows_the_divergence_of_two_runs():
    """An independent estimate: two runs whose starts differ by the tolerance."""
    tol, angles = 1e-10, (0.2 * np.pi, 0.8 * np.pi)
    times = np.linspace(0, 600, 6001)
    first = simulate(BASELINE, *angles, t_end=600.0, times=times)
    second = simulate(
        BASELINE, *angles, t_end=600.0, times=times, initial_state=(tol, 0, 0, 0)
    )
    apart = np.hypot(first.x - second.x, first.y - second.y)
    lost = float(times[np.argmax(apart.values > 1e-3)])
    result = hammering_map(BASELINE, [angles[0]], [angles[1]], t_end=600.0, tol=tol)
    assert result.outcome.item() == Outcome.beyond_horizon
    assert float(result.predictability_horizon.item()) == pytest.approx(lost, rel=0.25)


def test_whirl_without_a_law_says_so():
    result = whirl_sizes(BASELINE, [0.3, 0.5], t_end=300.0)
    assert np.isnan([result.slope, result.offset, *result.fit_range]).all()


def test_lifetimes_are_the_same_when_belt_speed_is_never_reached():
    results = [
        transient_lifetimes(BASELINE.with_(belt_speed=speed), samples=4, t_end=8000.0)
        for speed in (50.0, 200.0)
    ]
    np.testing.assert_array_equal(results[0].lifetime, results[1].lifetime)


def test_fit_of_the_whirl_states_its_range():
    result = whirl_sizes(BASELINE, [0.4, 0.7, 2.0, 40.0, 80.0, 160.0], t_end=3000.0)
    np.testing.assert_array_equal(result.fit_range, [40.0, 160.0])
    line = result.offset + result.slope * result.belt_speed
    apart = np.abs(result.amplitude / line - 1.0)
    assert apart[2] > 5 * apart[3:].max()


@pytest.mark.parametrize("speed", [20.0, -20.0])
def test_energy_line_of_unequal_springs_is_that_of_their_potential(speed):
    """At which x along the line through r = 0 both springs hold the energy of a fast passage."""
    params = FORMER.with_(
        mass=2.0, k1=0.6, k2=3.0, length1=2.0, length2=7.0, belt_speed=speed
    )
    sizes = whirl_sizes(params, [20.0], t_end=1.0)
    fast, cosine = 1e5, np.cos(SCENES["F3"].alpha1)

    def left_over(x):
        stretch = np.hypot(x - 2.0 * cosine, 2.0 * np.sqrt(1 - cosine**2)) - 2.0
        other = np.hypot(x - 7.0 * cosine, 7.0 * np.sqrt(1 - cosine**2)) - 7.0
        return 0.5 * (0.6 * stretch**2 + 3.0 * other**2 - params.mass * fast**2)

    far = brentq(left_over, 1e3, 1e6, rtol=1e-15)
    line = float(sizes.energy_offset) + float(sizes.energy_slope) * fast
    assert abs(line - far) < 1e-3


def test_long_runs_follow_the_direction_of_the_belt():
    """With unequal springs the belt's direction matters: the runs are those of this belt."""
    params = BASELINE.with_(belt_speed=-20.0, k2=1.3, length2=6.0)
    scene = SCENES["F3"]
    times = np.linspace(80.0, 100.0, 20_001)
    run = simulate(params, scene.alpha1, scene.alpha2, t_end=100.0, times=times)
    sizes = whirl_sizes(params, [20.0], t_end=100.0)
    assert float(sizes.belt_speed[0]) == -20.0
    np.testing.assert_allclose(sizes.amplitude, np.abs(run.x).max(), rtol=1e-5)
    other = whirl_sizes(params.with_(belt_speed=20.0), [20.0], t_end=100.0)
    assert abs(float(other.amplitude[0] / sizes.amplitude[0]) - 1.0) > 0.05


@pytest.mark.parametrize(
    ("model", "law"),
    [
        ("A1-linear-springs", {"friction_law": "linear 0:0.5 1:0.3"}),
        ("A1-no-separation", {"contact_law": "linear 0:0 1:1"}),
        ("A1-as-printed", {"contact_law": "dashpot"}),
    ],
)
def test_a_variant_names_the_law_that_it_cannot_carry(model, law):
    """A law was said to be A1's alone, which is not so, and which law was not said."""
    ((name, value),) = law.items()
    what = re.escape(f"model = '{model}' cannot carry {name} = '{value}'; use model")
    with pytest.raises(ValueError, match=what):
        simulate(Parameters(**law), 1.0, 2.0, t_end=1.0, model=model)
