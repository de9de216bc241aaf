"""What was computed of the baseline independently of this project."""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.dynamics.whirl import transient_lifetimes, whirl_sizes
from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome
from tests.former import FORMER

BASELINE = FORMER


def _map(points, **options):
    angles = np.linspace(0, np.pi, points)
    return validity_map(BASELINE, angles, angles, **options)


@pytest.mark.parametrize(
    ("options", "kept"),
    [
        ({"t_end": 100.0}, 2706),
        *(
            pytest.param(each, 2694, marks=pytest.mark.release)
            for each in ({"tol": 1e-15}, {"t_end": 400.0}, {"t_end": 1600.0})
        ),
    ],
    ids=str,
)
def test_cells_that_keep_contact_at_other_tolerances_and_horizons(options, kept):
    assert int((~_map(91, **options).separates).sum()) == kept


def test_2694_of_91_by_91_cells_keep_contact_and_none_of_them_is_linearly_unstable():
    result = _map(91)
    assert int((~result.separates).sum()) == 2694
    assert not (result.regime_linear.values[~result.separates.values] > 0).any()
    first = result.first_separation_time.values
    assert np.nanmedian(first) == pytest.approx(2.2, abs=0.05)
    assert np.nanmax(first) == pytest.approx(197.6, abs=0.05)


def test_10710_of_181_by_181_cells_keep_contact():
    assert int((~_map(181).separates).sum()) == 10_710


def test_growth_of_the_paper_saturates():
    scene = SCENES["F3"]
    run = run_ensemble(BASELINE, scene.alpha1, scene.alpha2, t_end=3000.0, t_late=500.0)
    assert run.early_max_x == pytest.approx(32.2, abs=0.5)
    assert run.late_max_x == pytest.approx(80.7, abs=0.05)


@pytest.mark.parametrize(
    ("speed", "late"), [pytest.param(100, 80.7, marks=pytest.mark.release), (10, 12.5)]
)
def test_size_of_the_whirl(speed, late):
    result = whirl_sizes(BASELINE, [speed, 150.0, 200.0, 300.0], t_end=6000.0)
    assert float(result.amplitude[0]) == pytest.approx(late, abs=0.05)
    assert float(result.stick_fraction[0]) < 0.01
    assert float(result.slope) == pytest.approx(float(result.energy_slope), rel=0.08)


def test_the_whirl_at_the_lowest_speed_sticks_and_is_chaotic_or_a_cycle():
    """At V = 1 few of many near starts settle on the cycle of amplitude 7.8223 by T = 6000."""
    scene = SCENES["F3"]
    starts = np.random.default_rng(0).uniform(-1e-6, 1e-6, (96, 4))
    run = run_ensemble(
        BASELINE.with_(belt_speed=1.0),
        scene.alpha1,
        scene.alpha2,
        t_end=6000.0,
        t_late=5000.0,
        initial_state=starts,
    )
    assert (run.late_max_x > 7.0).all()
    assert (run.late_max_x < 8.1).all()
    assert (run.sticks > 100).all()
    on_cycle = np.abs(run.late_max_x - 7.822256504) < 1e-6
    assert 0.01 < on_cycle.mean() < 0.5


def test_transient_after_the_start_of_the_whirl_at_low_speed():
    scene = SCENES["F3"]
    run = run_ensemble(
        BASELINE.with_(belt_speed=10.0), scene.alpha1, scene.alpha2, t_end=500.0
    )
    assert run.early_max_x == pytest.approx(13.1, abs=0.05)


def test_bounded_to_500_and_a_transient_beyond():
    scene = SCENES["F4"]
    short = run_ensemble(
        BASELINE, scene.alpha1, scene.alpha2, t_end=500.0, t_late=200.0
    )
    assert 9.4 < short.early_max_x <= 9.55
    assert 9.4 < short.late_max_x <= 9.75
    starts = np.zeros((24, 4))
    starts[:, 0] = np.linspace(-1e-9, 1e-9, 24)
    long = run_ensemble(
        BASELINE,
        scene.alpha1,
        scene.alpha2,
        t_end=9000.0,
        initial_state=starts,
        stop_at_turns=10,
    )
    left = long.outcome == Outcome.amplitude_reached
    assert left.mean() > 0.5
    assert long.time.min() > 1000


def test_slow_belt_never_lets_the_transient_end():
    left = [
        transient_lifetimes(
            BASELINE.with_(belt_speed=speed), samples=6, t_end=20_000.0
        ).lifetime
        for speed in (0.5, 3.0)
    ]
    assert not np.isfinite(left[0]).any()
    assert np.isfinite(left[1]).any()


def test_springs_along_the_belt():
    runs = [simulate(BASELINE, angle, angle, t_end=50.0) for angle in (0.0, np.pi)]
    force = [run.normalized_contact_force.values for run in runs]
    assert np.abs(force[0] - force[1]).max() < 1e-10
    long = simulate(BASELINE, 0.0, 0.0, t_end=200.0)
    assert float(long.y.max()) == pytest.approx(3.46, abs=0.01)
