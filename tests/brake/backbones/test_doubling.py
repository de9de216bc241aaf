"""Branches of doubled period: index at the switch, time integration, first integral, closure."""

import math

import numpy as np
import pytest

from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.doubling import doubled_branch
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.models.a4 import first_integral_value
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import solve_orbit
from squealpipe.brake.orbits.shorter_orbits import is_primitive
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.schema import Outcome
from squealpipe.store import load, save
from tests.former import FORMER
from tests.oracles.a4_scipy import a4_by_scipy

PI = math.pi
BASE = FORMER
SCENE = (0.3 * PI, 0.9 * PI)
OTHER = FORMER.with_(k1=1.1, k3=0.8, mu=0.25, mass=2.0, preload=0.5, belt_speed=-100.0)
"""Other units, unequal springs, the belt the other way: a mirror image leads to a doubling."""


@pytest.fixture(scope="module", params=[1, 2])
def branch(request):
    return doubled_branch(BASE, *SCENE, mode=1, doubling=request.param)


def _after_a_period(params, angles, orbit):
    """The state at the peak, after half a doubled period, and after a whole one."""
    times = 2.0 * PI / float(orbit.omega) * np.array([0.0, 0.5, 1.0])
    return a4_by_scipy(params, angles, orbit, times).T


def test_the_branch_starts_at_the_doubling(branch):
    simple = backbone(BASE, *SCENE, mode=1, y_peak_max=6.0)
    number = branch.attrs["doubling"] - 1
    peak = float(branch.y_largest[0])
    assert peak == pytest.approx(float(simple.special_y_peak[number]), rel=1e-12)
    assert peak == pytest.approx((3.919, 5.820)[number], abs=6e-4)
    assert float(branch.doubling_omega) == pytest.approx(
        2.0 * float(branch.omega[0]), rel=1e-14
    )


def test_the_index_is_continuous_at_the_switch(branch):
    """It starts at (−2)² − 2 = 2 and leaves it with the square of the distance, as ω does."""
    away = np.hypot(
        branch.x_at_peak - branch.x_at_peak[0], branch.y_peak - branch.y_peak[0]
    )
    near = slice(2, 5)  # beyond round-off, before terms of higher order
    for values in (branch.stability_index, branch.omega):
        change = np.abs(values - values[0]).values
        slope = np.polyfit(np.log(away.values[near]), np.log(change[near]), 1)[0]
        assert slope == pytest.approx(2.0, abs=0.1)
    assert float(branch.stability_index[0]) == pytest.approx(2.0, abs=1e-12)
    # one side of the doubling of a stable orbit: stable if it leaves downwards
    assert (
        np.sign(float(branch.stability_index[4]) - 2.0)
        == (-1, 1)[branch.attrs["doubling"] - 1]
    )


def test_orbits_close_after_the_doubled_period_and_not_before(branch):
    for point in (4, branch.sizes["point"] // 2, branch.sizes["point"] - 1):
        orbit = branch.isel(point=point)
        start, half, end = _after_a_period(BASE, SCENE, orbit)
        scale = 1.0 + np.abs(start).max()
        growth = max(1.0, abs(float(orbit.stability_index)))
        assert np.abs(end - start).max() < 1e-10 * growth * scale
        assert np.abs(half - start).max() > 1e-3
        energy = first_integral_value(
            *end, BASE, linear_stiffness(BASE, geometry(*SCENE))
        )
        np.testing.assert_allclose(energy, orbit.first_integral, rtol=1e-11)
    assert float(branch.residual.max()) < 1e-12


def test_no_orbit_of_the_branch_is_the_old_one_run_through_twice(branch):
    scene = scaled_system(BASE, *SCENE)
    for point in range(4, branch.sizes["point"], 5):
        here = branch.isel(point=point)
        guess = [here.x_at_peak, here.y_peak, PI * scene.frequency / here.omega]
        orbit = solve_orbit(scene.system, np.array(guess))
        if orbit is None:  # next to a fold of y_peak
            continue
        assert is_primitive(scene.system, orbit)
        ends = sample(scene.system.rows, orbit.point, np.array([0.0, PI]))
        assert np.abs(ends[0, :2] - ends[1, :2]).max() > 1e-3


def test_a_doubling_in_other_units_with_the_belt_the_other_way():
    """x → −x and V → −V: (α1, α2) becomes (π − α1, π − α2)."""
    angles = (PI - SCENE[0], PI - SCENE[1])
    branch = doubled_branch(OTHER, *angles, mode=1, y_peak_max=8.0 * OTHER.preload)
    assert branch.sizes["point"] > 10
    at_doubling = periodic_orbit(
        OTHER, *angles, mode=1, y_peak=float(branch.y_largest[0])
    )
    assert float(at_doubling.stability_index) == pytest.approx(-2.0, abs=1e-9)
    start, _, end = _after_a_period(
        OTHER, angles, branch.isel(point=branch.sizes["point"] // 2)
    )
    assert np.abs(end - start).max() < 1e-10


def test_a_branch_that_closes_meets_an_orbit_of_half_its_period():
    branch = doubled_branch(BASE, 0.2 * PI, 0.7 * PI, mode=1)
    assert int(branch.end) == Outcome.tongue_end
    assert float(branch.stability_index[-1]) == pytest.approx(2.0, abs=0.02)


def test_without_a_doubling_the_dataset_is_empty_with_its_reason(tmp_path):
    for options in ({"doubling": 3}, {"y_peak_max": 3.0}):
        empty = doubled_branch(BASE, *SCENE, mode=1, **options)
        assert empty.sizes["point"] == 0
        assert int(empty.end) == Outcome.no_doubling
        assert np.isnan(float(empty.doubling_omega))
        assert load(save(empty, tmp_path / "empty.nc")).equals(empty)
        (tmp_path / "empty.nc").unlink()
    singular = doubled_branch(BASE, 0.4 * PI, 0.6 * PI, mode=1)
    assert int(singular.end) == Outcome.singular_static_state
