"""Single orbits and branches come from one trace: they agree, also with a much finer one."""

import math
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from squealpipe.brake.a4.orbits import grazing_start
from squealpipe.brake.a4.system import scaled_system
from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.models.a4 import first_integral_value
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import solve_orbit
from squealpipe.brake.orbits.shorter_orbits import is_primitive
from squealpipe.brake.orbits.tracing import TraceEnd, orbit_on_branch
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.schema import Outcome
from tests.former import FORMER

PI = math.pi
BASE = FORMER
LEFT = (0.85 * PI, 11 * PI / 180)
"""Here mode 1 ends at y = 1.091 in the resonance 1:2."""


def _random_cells(count, seed):
    """Random parameters, angles, modes and peaks with a linear mode that can lose contact."""
    random = np.random.default_rng(seed)
    found = 0
    while found < count:
        k1, k2, k3 = random.uniform(0.3, 3.0, 3)
        params = FORMER.with_(
            k1=k1,
            k2=k2,
            k3=k3,
            mu=random.uniform(0, 0.8),
            belt_speed=random.choice([-1, 1]) * 50.0,
        )
        angles = random.uniform(0.0, PI, 2)
        mode = int(random.integers(1, 3))
        peak = 1.0 + 10.0 ** random.uniform(-3.0, 0.6)
        scene = scaled_system(params, *angles)
        if scene.obstacle == Outcome.converged and scene.rest[1] < 1.0:
            found += 1
            yield params, angles, mode, peak, scene


def test_an_orbit_beyond_the_end_of_its_branch_is_one_of_another_branch():
    branch = backbone(BASE, *LEFT, mode=1)
    assert int(branch.end) == Outcome.tongue_end
    assert float(branch.y_peak.max()) == pytest.approx(1.0910, abs=1e-4)
    single = periodic_orbit(BASE, *LEFT, mode=1, y_peak=2.0)
    assert int(single.outcome) == Outcome.other_branch
    assert float(single.omega) == pytest.approx(0.43278, abs=1e-5)
    assert float(single.residual) < 1e-13
    scene = scaled_system(BASE, *LEFT)
    point = np.array(
        [float(single.x_at_peak), 2.0, PI * scene.frequency / float(single.omega)]
    )
    orbit = solve_orbit(scene.system, point)
    assert is_primitive(scene.system, orbit)
    thrice = replace(orbit, point=orbit.point * [1.0, 1.0, 3.0])
    assert not is_primitive(scene.system, thrice)


def test_a_branch_that_arrives_is_not_called_lost():
    cell = (0.6327227031610345, 1.4254322602884113)
    peak = 1.0077772732661257
    single = periodic_orbit(BASE, *cell, mode=1, y_peak=peak)
    branch = backbone(BASE, *cell, mode=1, y_peak_max=peak)
    assert int(single.outcome) == Outcome.converged
    assert int(branch.end) == Outcome.amplitude_reached
    assert float(branch.y_peak.max()) == pytest.approx(peak, abs=1e-15)
    assert float(single.omega) == pytest.approx(float(branch.omega[-1]), abs=1e-13)


@pytest.mark.release
def test_single_orbits_agree_with_branches_in_random_cells():
    """Unequal springs, both belt directions, any μ and k3: to the peak, and on to twice it."""
    ends = set()
    for params, angles, mode, peak, _ in _random_cells(60, seed=7):
        single = periodic_orbit(params, *angles, mode=mode, y_peak=peak)
        outcome = Outcome(int(single.outcome))
        ends.add(outcome)
        for reach in (peak, 2.0 * peak):
            branch = backbone(params, *angles, mode=mode, y_peak_max=reach)
            arrives = float(branch.y_peak.max()) >= peak * (1.0 - 1e-12)
            assert arrives == (outcome == Outcome.converged), (
                params,
                angles,
                mode,
                peak,
            )
            if reach == peak and arrives:
                assert int(branch.end) == Outcome.amplitude_reached
                assert float(single.omega) == pytest.approx(
                    float(branch.omega[-1]), rel=1e-11
                )
    assert {Outcome.converged, Outcome.other_branch} <= ends


def test_steps_twenty_times_finer_follow_the_same_branches():
    """Where both arrive ω agrees; no trace arrives where the other meets an end for sure."""
    sure = (TraceEnd.tongue_end, TraceEnd.retraced)
    for _, _, mode, peak, scene in _random_cells(60, seed=11):
        if scene.system.decoupled:
            continue
        seed = grazing_start(scene, mode)
        control = seed.settings()
        steps = 0.05 * control.longest_step, min(control.first_step, 5e-4)
        fine = replace(
            control,
            longest_step=steps[0],
            first_step=steps[1],
            least_cosine=0.995,
            max_points=40_000,
        )
        start = scene.system, seed.point, seed.direction, peak
        both = (orbit_on_branch(*start, settings) for settings in (control, fine))
        orbits, ends = zip(*both, strict=True)
        if None not in orbits:
            assert orbits[0].omega == pytest.approx(orbits[1].omega, rel=1e-10)
        else:
            assert not (TraceEnd.amplitude_reached in ends and set(ends) & set(sure)), (
                ends,
                peak,
            )


def test_the_first_integral_and_the_larger_peak_hold_along_a_tongue():
    """Both instants of rest of each point have one energy, and y_peak is the larger y."""
    branch = backbone(BASE, *LEFT, mode=1)
    scene, stiffness = (
        scaled_system(BASE, *LEFT),
        linear_stiffness(BASE, geometry(*LEFT)),
    )
    points = np.stack(
        [branch.x_at_peak, branch.y_peak, PI * scene.frequency / branch.omega]
    )
    for point in points.T:
        orbit = solve_orbit(scene.system, point)
        if orbit is None:
            continue
        ends = sample(scene.system.rows, orbit.point, np.array([0.0, PI]))
        energies = [first_integral_value(*end, BASE, stiffness) for end in ends]
        assert energies[0] == pytest.approx(energies[1], rel=1e-9, abs=1e-12)
        assert ends[0, 1] >= ends[1, 1] - 1e-9


EXTREME = [
    ({"k1": 1e12, "k2": 0.2148, "k3": 1.633}, (2.0148, 2.6786), 1.01),
    ({"k1": 1e6, "k2": 0.2148, "k3": 1.633}, (2.0148, 2.6786), 1.01),
    ({"preload": 5e-324}, (0.3 * PI, 0.9 * PI), 1e-323),
    ({}, (0.3 * PI, 0.9 * PI), 1e99),
    ({"mu": 1e300}, (0.3 * PI, 0.9 * PI), 2.0),
    ({"length2": 1e-170}, (0.3 * PI, 0.9 * PI), 2.0),
]


@pytest.mark.timeout(60)
@pytest.mark.parametrize(("changes", "angles", "peak"), EXTREME)
@pytest.mark.parametrize("mode", [1, 2])
def test_extreme_ratios_end_soon_with_an_outcome(changes, angles, peak, mode):
    params = FORMER.with_(**changes)
    single = periodic_orbit(params, *angles, mode=mode, y_peak=peak)
    branch = backbone(params, *angles, mode=mode)
    assert np.isfinite(float(single.omega)) == (
        int(single.outcome) == Outcome.converged
    )
    assert Outcome(int(branch.end)) is not Outcome.not_computed


@pytest.mark.parametrize("name", ["mass", "k1", "k2", "k3"])
@pytest.mark.parametrize("value", [1e300, 1e-300])
def test_numbers_whose_squares_overflow_are_named(name, value):
    scene = FORMER.with_(**{name: value}), 1.0, 2.0
    words = re.escape(f"{name} = {value!r}: between") + ".*choose other units"
    for given in (partial(periodic_orbit, y_peak=2.0), backbone):
        with pytest.raises(ValueError, match=words):
            given(*scene, mode=1)


def test_lengths_beyond_doubles_are_named():
    for peak in (1e155, 10**400):
        with pytest.raises(ValueError, match="y_peak = "):
            periodic_orbit(BASE, 1.0, 2.0, mode=1, y_peak=peak)
    with pytest.raises(ValueError, match=r"y_peak = 1\.0: more than .* preload"):
        periodic_orbit(FORMER.with_(preload=5e-324), 1.0, 2.0, mode=1, y_peak=1.0)
