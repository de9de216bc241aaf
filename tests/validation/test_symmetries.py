"""Symmetries of A1 and A4 that no code can have by accident."""

import numpy as np
import pytest

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from tests.former import FORMER

RNG = np.random.default_rng(5)
ALPHA1, ALPHA2 = RNG.uniform(0, np.pi, (2, 60))
TIMES = np.linspace(0, 12, 25)
MODELS = ("A1", "A1-no-separation", "A1-linear-springs", "A4")


def run(params, alpha1, alpha2, model="A1", **options):
    return run_ensemble(
        params,
        alpha1,
        alpha2,
        t_end=12.0,
        model=model,
        times=TIMES,
        log_events=30,
        **options,
    )


def assert_mirrored(first, second, signs):
    np.testing.assert_array_equal(first.event_kinds, second.event_kinds)
    np.testing.assert_allclose(second.samples, first.samples * signs, atol=1e-9)


@pytest.mark.parametrize("speed", [100.0, 0.3, 0.05])
@pytest.mark.parametrize("model", MODELS)
def test_mirror_images(model, speed):
    """x → −x gives (π − α1, π − α2, −V), and for equal springs (α2, α1, −V): the same system as
    (π − α2, π − α1, V)."""
    belt, other = (FORMER.with_(belt_speed=sign * speed) for sign in (1, -1))
    first, mirrored = run(belt, ALPHA1, ALPHA2, model), [-1, 1, -1, 1]
    assert_mirrored(
        first, run(belt, np.pi - ALPHA2, np.pi - ALPHA1, model), [1, 1, 1, 1]
    )
    assert_mirrored(first, run(other, ALPHA2, ALPHA1, model), mirrored)
    assert_mirrored(first, run(other, np.pi - ALPHA1, np.pi - ALPHA2, model), mirrored)


def test_one_dashpot_alone_damps_whichever_spring_has_it():
    """Springs that are alike change their names by (α1, α2) → (π − α2, π − α1)."""
    first, second = (
        FORMER.with_(damping1=one, damping2=other)
        for one, other in ((0.2, 0.0), (0.0, 0.2))
    )
    one = run(first, ALPHA1, ALPHA2)
    other = run(second, np.pi - ALPHA2, np.pi - ALPHA1)
    assert_mirrored(one, other, [1, 1, 1, 1])
    undamped = run(FORMER, ALPHA1, ALPHA2)
    assert np.nanmax(np.abs(one.samples - undamped.samples)) > 0.1


def test_linear_maps_mirror_with_the_belt():
    # No special angles: there a unit of round-off decides.
    angles = np.sort(RNG.uniform(0.0, np.pi, 13))
    params = FORMER.with_(k2=1.7, belt_speed=2.0)
    mirrored = params.with_(belt_speed=-2.0)
    for make in (stability_map, quasi_static_map, natural_frequencies):
        first = make(params, angles, angles)
        # The map of a reversed belt, its rows and columns from π down to 0.
        second = make(mirrored, np.pi - angles, np.pi - angles)
        # Eq. (11) as printed is taken literally: it knows no direction of the belt.
        for name, values in first.drop_vars(
            "possible_as_printed", errors="ignore"
        ).items():
            other = second[name].values
            if name in ("x_static", "stiffness_xy"):
                other = -other
            np.testing.assert_allclose(
                other, values.values, rtol=1e-9, atol=1e-9, err_msg=name
            )


@pytest.mark.parametrize("mode", [1, 2])
def test_orbits_mirror_with_the_belt(mode):
    first = periodic_orbit(FORMER, 0.3 * np.pi, 0.9 * np.pi, mode=mode, y_peak=1.5)
    reversed_belt = FORMER.with_(belt_speed=-100.0)
    second = periodic_orbit(
        reversed_belt, 0.7 * np.pi, 0.1 * np.pi, mode=mode, y_peak=1.5
    )
    assert float(second.omega) == pytest.approx(float(first.omega), rel=1e-12)
    assert int(second.sliding_assumption) == int(first.sliding_assumption)
    np.testing.assert_allclose(second.x_at_peak, -first.x_at_peak, rtol=1e-9)
