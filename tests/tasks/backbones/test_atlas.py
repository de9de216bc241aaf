"""The atlas: outcomes everywhere, agreement with single orbits, the mirror."""

import math

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.tasks.backbones.atlas import orbit_atlas
from squealpipe.tasks.backbones.orbit import periodic_orbit
from tests.former import FORMER

ANGLES = np.linspace(0.0, math.pi, 25)


def test_atlas_has_an_outcome_everywhere_and_agrees_with_single_orbits():
    atlas = orbit_atlas(FORMER, ANGLES, ANGLES)
    assert not (atlas.outcome == Outcome.not_computed).any()
    held = np.isin(atlas.outcome, (Outcome.converged, Outcome.other_branch))
    assert np.isfinite(atlas.omega.values[held]).all()
    elsewhere = np.isin(
        atlas.outcome,
        (
            Outcome.complex_pair,
            Outcome.divergence,
            Outcome.singular_static_state,
            Outcome.isolated_mode,
            Outcome.rigid_mode,
        ),
    )
    assert held.sum() >= 0.96 * (~elsewhere).sum()
    direct = np.argwhere((atlas.outcome == Outcome.converged).values)
    for i, j, k in direct[:: max(1, len(direct) // 20)]:
        single = periodic_orbit(
            FORMER, float(ANGLES[i]), float(ANGLES[j]), mode=int(k) + 1, y_peak=2.0
        )
        assert abs(float(single.omega) - float(atlas.omega[i, j, k])) < 1e-13


def test_atlas_is_its_own_mirror_image():
    """(α1, α2) → (π − α2, π − α1) where both cells hold the motion of a mode away from
    resonances, which round-off may resolve differently."""
    atlas = orbit_atlas(FORMER, ANGLES, ANGLES)
    omega = atlas.omega.values
    mirrored = omega[::-1, ::-1].transpose(1, 0, 2)
    both = np.isfinite(omega) & np.isfinite(mirrored)
    alike = np.abs(omega[both] - mirrored[both]) < 1e-10
    assert alike.mean() > 0.99


def test_threads_do_not_change_the_atlas():
    some = ANGLES[2:8]
    one, two = (orbit_atlas(FORMER, some, some, workers=count) for count in (1, 2))
    np.testing.assert_array_equal(one.omega, two.omega)
