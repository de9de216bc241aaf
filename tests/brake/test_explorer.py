"""The explorer's dataset against the tasks that it collects."""

import numpy as np
import pytest

from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.explorer import explorer_data
from squealpipe.schema import Outcome
from tests.former import FORMER

ANGLES = np.array([0.5, 5 / 6, 1.0]) * np.pi
OPTIONS = {
    "history_time": 20.0,
    "spectrum_time": 60.0,
    "samples": 101,
    "branch_points": 6,
}


@pytest.fixture(scope="module")
def explorer():
    return explorer_data(FORMER, ANGLES, workers=1, **OPTIONS)


def test_motion_is_that_of_simulate(explorer):
    alone = simulate(
        FORMER, ANGLES[1], ANGLES[2], t_end=20.0, times=np.linspace(0, 20, 101)
    )
    for name in ("x", "y", "normalized_contact_force"):
        np.testing.assert_allclose(explorer[name][1, 2], alone[name], atol=1e-6)


def test_spectrum_peaks_at_the_natural_frequency_of_the_closed_form(explorer):
    spectrum = explorer.force_spectrum[0, 2]
    highest = float(explorer.frequency[int(np.argmax(spectrum.values))])
    assert highest == pytest.approx(np.sqrt(1.75), abs=np.pi / 60)


def test_branches_run_from_first_to_last_point_of_the_backbone(explorer):
    for k, mode in enumerate((1, 2)):
        alone = backbone(FORMER, ANGLES[1], ANGLES[1], mode=mode)
        shown = explorer.isel(alpha1=1, alpha2=1, mode=k)
        np.testing.assert_allclose(
            shown.omega[[0, -1]], alone.omega[[0, -1]], rtol=1e-6
        )
        assert int(shown.end) == int(alone.end)


def test_a_pair_without_a_mode_says_why(explorer):
    assert np.isnan(explorer.omega[0, 0]).all()
    assert (explorer.end[0, 0] == Outcome.rigid_mode).all()


def test_a_table_of_contact_is_explored():
    # as many angles as samples, where a transposed array would have the same shape
    stiffening = FORMER.with_(contact_law="cubic 0:0 0.5:0.2 1:0.75 2:4")
    few = {**OPTIONS, "samples": len(ANGLES)}
    found = explorer_data(stiffening, ANGLES, workers=1, **few)
    times = found.time.values
    alone = simulate(stiffening, ANGLES[1], ANGLES[2], t_end=20.0, times=times)
    force = alone.normalized_contact_force.values
    assert np.ptp(force) > 0.1
    np.testing.assert_allclose(found.normalized_contact_force[1, 2], force, atol=1e-6)


def test_mirror_images_are_copied_and_are_what_runs_give():
    """(α1, α2), (π − α2, π − α1) swap the springs; where these differ by a hair all pairs run."""
    angles = np.array([1 / 6, 0.5, 5 / 6]) * np.pi
    apart = FORMER.with_(length2=FORMER.length2 * (1.0 + 1e-13))
    copied, run = (
        explorer_data(params, angles, workers=1, **OPTIONS)
        for params in (FORMER, apart)
    )
    for name in ("x", "y", "force_spectrum", "outcome", "end"):
        np.testing.assert_allclose(copied[name], run[name], rtol=1e-5, atol=1e-6)
    # round-off decides the steps between the ends of a branch
    ends = (each.omega[..., [0, -1]] for each in (copied, run))
    np.testing.assert_allclose(*ends, rtol=1e-5)
    image = copied.x.values[::-1, ::-1].swapaxes(0, 1)
    np.testing.assert_array_equal(copied.x, image)
    assert np.ptp(copied.x.values[2, 1]) > 0.1
