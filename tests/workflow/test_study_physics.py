"""What the paper's figures show, read from the datasets of a study as `snakemake` made them.

Each test would fail if the physics behind its figure were wrong; grids of the tiny study are
coarse, but the scenes run to the paper study's full horizons.
"""

from __future__ import annotations

import numpy as np
import pytest

from squealpipe.codes import Event
from squealpipe.parameters import SCENES, Parameters
from squealpipe.store import load


@pytest.fixture(scope="module")
def scene(tiny_study):
    return lambda name: load(tiny_study.results / f"data/simulate/{name}.nc")


@pytest.mark.parametrize(
    ("name", "kept"), [("F2a", True), ("F2b", True), ("F2c", True), ("F2d", False)]
)
def test_contact_is_kept_in_the_first_three_scenes_and_lost_in_the_fourth(scene, name, kept):
    run = scene(name)
    assert (float(run.normalized_contact_force.min()) > 0) == kept


def test_linear_limit_of_the_lowest_contact_force(scene):
    # K = diag(k, k) without cubic terms: lowest F/F0 = (1 − κ)/(1 + κ); λ = 15 shifts it little.
    kappa = Parameters().kappa
    lowest = [float(scene(name).normalized_contact_force.min()) for name in ("F2a", "F2b", "F2c")]
    np.testing.assert_allclose(lowest, (1 - kappa) / (1 + kappa), atol=0.08)


def test_the_two_horizontal_arrangements_are_identical(scene):
    first, second = scene("F5a"), scene("F5b")
    np.testing.assert_allclose(first.x, second.x, atol=1e-10)
    np.testing.assert_allclose(first.y, second.y, atol=1e-10)
    assert float(first.y.max()) > 2 * Parameters().preload
    assert (first.event_kind == Event.separation).sum() >= 4


def test_the_pendulum_is_pumped_past_thirty(scene):
    run = scene("F3")
    assert float(run.time[-1]) == SCENES["F3"].t_end == 500
    assert float(np.abs(run.x).max()) > 30
    early = float(np.abs(run.x).where(run.time <= 200, drop=True).max())
    assert early < float(np.abs(run.x).max())


def test_the_swing_of_fig_4_stays_below_two_lengths(scene):
    run = scene("F4")
    assert float(run.time[-1]) == 500
    largest = float(np.abs(run.x).max())
    assert 15.0 < largest < 2 * Parameters().length1


def test_as_printed_a1_and_the_linear_model_disagree_about_the_sign_and_corrected_they_agree(
    tiny_study,
):
    for folder, agree in (("", False), ("corrected/", True)):
        data = tiny_study.results / f"data/{folder}"
        run = load(data / "simulate/F2a.nc")
        static = load(data / "quasi_static_map.nc").x_static
        linear = static.sel(alpha1=np.pi / 2, alpha2=np.pi, method="nearest")
        assert (float(run.x.mean()) * float(linear) > 0) == agree


def test_the_black_region_of_fig_7_is_there_as_printed_only(tiny_study):
    for folder, there in (("", True), ("corrected/", False)):
        validity = load(tiny_study.results / f"data/{folder}validity_map.nc")
        assert bool(((validity.separates == 0) & (validity.regime_linear > 0)).any()) == there


@pytest.mark.parametrize("figure", ["F10", "F11", "F12", "F13"])
def test_branches_bend_to_lower_frequency_past_contact_loss(tiny_study, figure):
    mode = 1 if figure == "F13" else 2
    branch = load(tiny_study.results / f"data/backbone/{figure}_mode{mode}.nc")
    separated = branch.where(branch.y_peak > 1.001 * Parameters().preload, drop=True)
    assert separated.sizes["point"] > 5
    by_amplitude = separated.sortby("y_peak")
    assert float(by_amplitude.omega[-1]) < float(by_amplitude.omega[0])
    assert (np.diff(by_amplitude.omega) < 0).mean() > 0.9
