"""Backbones: ends, special points, both methods against each other, the paper's statements."""

import math

import numpy as np
import pytest

from squealpipe.brake.a4 import exact_branches
from squealpipe.brake.backbones.backbone import (
    backbone,
    contact_losing_branches,
    with_orbits,
)
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.schema.backbones import Assumption
from squealpipe.codes import SpecialPoint
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from tests.former import FORMER

PI = math.pi
BASE = FORMER


def _branch(alpha1, alpha2, mode, **options):
    return backbone(BASE, alpha1 * PI, alpha2 * PI, mode=mode, **options)


def test_period_doublings_are_located():
    """The index of single orbits, each found from cold, is −2 there and beyond it in between."""
    found = _branch(0.3, 0.9, 1, y_peak_max=7.0)
    doublings = found.special_kind.values == SpecialPoint.period_doubling
    np.testing.assert_allclose(
        found.special_y_peak[doublings], [3.919, 5.820], atol=6e-4
    )

    def index(peak):
        orbit = periodic_orbit(BASE, 0.3 * PI, 0.9 * PI, mode=1, y_peak=float(peak))
        return float(orbit.stability_index)

    for peak in found.special_y_peak.values:
        assert index(peak) == pytest.approx(-2.0, abs=1e-9)
    assert index(4.9) < -2.0 < min(index(3.9), index(5.84))


def test_a_period_doubling_just_above_grazing_is_found():
    params = Parameters(
        k2=0.75237, k3=0.650825, mu=0.270188, length1=5, length2=5, belt_speed=100
    )
    found = backbone(params, 2.655067, 1.06432, mode=2, y_peak_max=6.0)
    assert found.special_kind.values.tolist() == [SpecialPoint.period_doubling]
    peak = float(found.special_y_peak[0])
    assert peak == pytest.approx(1.0073, abs=1e-4)
    at = [
        float(
            periodic_orbit(
                params, 2.655067, 1.06432, mode=2, y_peak=near * peak
            ).stability_index
        )
        for near in (0.999, 1.0, 1.001)
    ]
    assert at[0] > -2.0 > at[2]
    assert at[1] == pytest.approx(-2.0, abs=1e-9)


@pytest.mark.parametrize(
    ("seed", "count"),
    [(0, 2), *(pytest.param(n, 12, marks=pytest.mark.release) for n in range(4))],
)
def test_special_points_of_random_branches_are_those_of_dense_samples(
    seed, count, monkeypatch
):
    """Each change of sign between 20 times as many orbits has its special point."""
    rng = np.random.default_rng(seed)
    compared = 0
    for _ in range(count):
        k2, k3, mu = rng.uniform([0.5, 0.2, 0.02], [2.0, 2.0, 0.8])
        params = Parameters(k2=k2, k3=k3, mu=mu, length1=5, length2=5, belt_speed=100)
        angles, mode = rng.uniform(0.0, PI, 2), int(rng.integers(1, 3))
        found = backbone(params, *angles, mode=mode, y_peak_max=6.0)
        with monkeypatch.context() as patch:
            patch.setattr(exact_branches, "POINT_SPACING", 0.001)
            dense = backbone(params, *angles, mode=mode, y_peak_max=6.0)
        beyond = dense.outcome.isin([Outcome.grazing, Outcome.converged]).values
        index = dense.stability_index.values[beyond]
        for kind, value in (
            (SpecialPoint.period_doubling, -2.0),
            (SpecialPoint.index_two, 2.0),
        ):
            off = index - value
            crossings = int((np.diff(np.sign(off[abs(off) > 1e-9])) != 0).sum())
            number = int((found.special_kind == kind).sum())
            assert number >= crossings, (kind, params, angles, mode)
            assert number % 2 == crossings % 2, (kind, params, angles, mode)
            compared += crossings
    assert compared > 0.4 * count


@pytest.mark.parametrize(
    ("alpha1", "alpha2", "mode"),
    [
        (0.5, 1.0, 2),
        (5 / 6, 5 / 6, 1),
        (0.2, 0.7, 1),
        pytest.param(0.3, 0.9, 1, marks=pytest.mark.release),
        pytest.param(0.3, 0.9, 2, marks=pytest.mark.release),
    ],
)
def test_both_methods_give_one_branch(alpha1, alpha2, mode):
    exact = _branch(alpha1, alpha2, mode, y_peak_max=4.0)
    series = _branch(alpha1, alpha2, mode, y_peak_max=4.0, method="hbm", n_harmonics=32)
    assert int(exact.end) == int(series.end) == Outcome.amplitude_reached
    assert np.isfinite(series.omega_exact).all()
    near = periodic_orbit(BASE, alpha1 * PI, alpha2 * PI, mode=mode, y_peak=4.0)
    index = float(near.stability_index)  # also inside the window of period doubling
    assert float(series.stability_index[-1]) == pytest.approx(index, abs=1e-3)
    assert float(abs(series.omega - series.omega_exact).max()) < 5e-7
    assert float(series.waveform_error.max()) < 1e-3
    assert float(series.integration_error.max()) < 1e-3
    between = np.interp(series.y_peak, exact.y_peak, exact.omega)
    np.testing.assert_allclose(series.omega, between, atol=2e-3)
    for name in ("x_amplitude", "y_amplitude", "largest_speed"):
        values = np.interp(series.y_peak, exact.y_peak, exact[name])
        np.testing.assert_allclose(series[name], values, rtol=2e-2, atol=1e-3)


def test_an_isolated_mode_is_a_vertical_branch_with_its_own_outcome():
    found = _branch(0.5, 1.0, 1, x_amplitude_max=2.0)
    assert (found.outcome == Outcome.isolated_mode).all()
    np.testing.assert_allclose(found.omega, 1.0, rtol=1e-15)
    np.testing.assert_allclose(found.y_amplitude, 0.0, atol=1e-15)
    assert float(found.x_amplitude[-1]) == pytest.approx(2.0)


def test_the_point_that_just_touches_the_end_of_contact_is_flagged():
    for method in ("exact", "hbm"):
        found = _branch(0.3, 0.9, 1, method=method)
        grazing = found.y_peak[found.outcome == Outcome.grazing]
        np.testing.assert_allclose(grazing, [BASE.preload], rtol=1e-14)


@pytest.mark.parametrize("method", ["exact", "hbm"])
def test_a_pole_ends_the_branch_unless_its_other_side_is_asked_for(method):
    """At (0.95π, 0.95π) the y mode passes ω_x/2: x is driven at resonance."""
    ended = _branch(0.95, 0.95, 1, method=method)
    assert int(ended.end) == Outcome.pole
    beyond = _branch(0.95, 0.95, 1, method=method, cross_poles=True)
    assert int(beyond.end) == Outcome.amplitude_reached
    pole = math.sqrt(2.0) * abs(math.cos(0.95 * PI)) / 2.0
    assert float(ended.omega.min()) > pole > float(beyond.omega.min())


def test_a_branch_that_turns_into_a_resonance_says_so():
    found = _branch(0.0, 51 / 60, 1, y_peak_max=2.0)
    assert int(found.end) in (Outcome.pole, Outcome.tongue_end, Outcome.retraced)
    assert SpecialPoint.fold in found.special_kind.values
    assert float(found.y_peak.max()) < 2.0


@pytest.mark.parametrize("method", ["exact", "hbm"])
def test_scenes_without_backbone_are_empty_with_a_reason(method):
    ends = {
        (0.75, 0.85): Outcome.complex_pair,
        (0.4, 0.6): Outcome.singular_static_state,
        (0.44, 0.57): Outcome.divergence,
    }
    for angles, end in ends.items():
        found = _branch(*angles, 1, method=method)
        assert (found.sizes["point"], Outcome(int(found.end))) == (0, end)


def test_settings_of_harmonic_balance_out_of_range_are_named():
    for name, wrong in (
        ("n_time", {"n_harmonics": 8, "n_time": 16}),
        ("sigma", {"sigma": 0.0}),
    ):
        with pytest.raises(ValueError, match=name):
            backbone(BASE, 1.0, 2.0, mode=1, method="hbm", **wrong)


@pytest.mark.parametrize(
    ("speed", "mode"),
    [
        (-100.0, 1),
        (0.5, 1),
        (100.0, 2),
        (-0.5, 2),
        *(
            pytest.param(*each, marks=pytest.mark.release)
            for each in ((100.0, 1), (-0.5, 1), (-100.0, 2), (0.5, 2))
        ),
    ],
)
def test_both_methods_judge_sliding_alike_for_either_belt_direction(speed, mode):
    params = FORMER.with_(belt_speed=speed)
    held = []
    for options in ({"method": "exact"}, {"method": "hbm", "n_harmonics": 32}):
        branch = backbone(params, 0.3 * PI, 0.9 * PI, mode=mode, **options)
        holds = branch.sliding_assumption.values == Assumption.holds
        np.testing.assert_array_equal(holds, branch.largest_speed.values < abs(speed))
        clear = abs(branch.largest_speed.values - abs(speed)) > 0.01
        held.append(
            np.interp(np.linspace(0.3, 2.9, 14), branch.y_peak[clear], holds[clear])
        )
    assert np.array_equal(held[0] > 0.5, held[1] > 0.5)
    assert held[0].all() == (abs(speed) == 100.0)


def test_branches_without_orbits_are_left_out_with_their_reason():
    # With unequal springs the x mode of F10 comes second: it is isolated and never separates.
    found = contact_losing_branches({"coupled": (0.3, 0.9)})
    kept, left_out = with_orbits(FORMER.with_(k2=2.0), found, [2.0])
    assert "F10 mode 2" not in kept
    assert "F10 mode 2: isolated_mode" in left_out
    everything, nothing = with_orbits(FORMER, found, [2.0])
    assert everything == found
    assert nothing == ""
    with pytest.raises(ValueError, match="no branch has orbits"):
        with_orbits(FORMER.with_(k2=2.0), {"F10 mode 2": found["F10 mode 2"]}, [2.0])


@pytest.mark.parametrize(("alpha1", "alpha2"), [(0.4, 0.55), (0.3, 0.9), (0.2, 0.7)])
@pytest.mark.parametrize("n_harmonics", [4, 16])
def test_no_series_far_from_every_exact_orbit_is_called_converged(
    alpha1, alpha2, n_harmonics
):
    branch = _branch(alpha1, alpha2, 1, method="hbm", n_harmonics=n_harmonics)
    converged = branch.where(branch.outcome == Outcome.converged, drop=True)
    assert float(converged.waveform_error.max()) <= 0.05
    far = branch.where(branch.waveform_error > 0.05, drop=True)
    assert (far.outcome == Outcome.unconfirmed).all()
    assert ((alpha1, alpha2) == (0.3, 0.9)) <= (far.sizes["point"] == 0)
