"""Figures of the linear topic show what their datasets hold."""

import numpy as np
import pytest
import xarray as xr

from squealpipe.brake.linear import boundaries as linear_boundaries
from squealpipe.brake.linear import critical
from squealpipe.brake.linear import maps as linear
from squealpipe.paper.figures.linear import (
    critical_friction,
    fig06,
    fig07,
    fig08,
    fig09,
)
from squealpipe.parameters import SCENES
from tests.former import FORMER

ANGLES = np.linspace(0.0, np.pi, 61)
BASELINE = FORMER


@pytest.fixture(scope="module")
def maps():
    return {
        "stability": linear.stability_map(BASELINE, ANGLES, ANGLES),
        "quasi_static": linear.quasi_static_map(BASELINE, ANGLES, ANGLES),
        "frequencies": linear.natural_frequencies(BASELINE, ANGLES, ANGLES),
        "boundaries": linear_boundaries.stability_boundaries(BASELINE, points=41),
    }


def mesh_values(axes):
    """Values of a panel's map, indexed by (alpha1, alpha2)."""
    return np.asarray(axes.images[0].get_array()).T


def test_fig06_tones_are_the_two_readings(maps):
    figure = fig06.draw(maps["stability"], maps["quasi_static"], maps["boundaries"])
    unstable = maps["stability"].regime_linear.values > 0
    readings = (maps["quasi_static"].possible_as_printed, maps["quasi_static"].possible)
    for axes, possible in zip(figure.axes, readings, strict=True):
        tones = mesh_values(axes)
        np.testing.assert_array_equal(tones == 2, unstable)
        np.testing.assert_array_equal(tones == 0, possible.values & ~unstable)
        crosses = [line for line in axes.get_lines() if line.get_marker() == "x"]
        assert [line.get_xydata().tolist() for line in crosses] == [
            [[SCENES["F3"].alpha1, SCENES["F3"].alpha2]]
        ]


@pytest.mark.parametrize(("module", "mode"), [(fig08, 1), (fig09, 2)])
def test_frequency_maps_show_both_states(maps, module, mode):
    figure = module.draw(maps["frequencies"])
    for axes, state in zip(figure.axes[:2], ("contact", "separated"), strict=True):
        omega = maps["frequencies"].omega.sel(mode=mode, contact_state=state)
        np.testing.assert_array_equal(mesh_values(axes), omega)
    scales = [axes.images[0].get_clim() for axes in figure.axes[:2]]
    assert scales[0] == scales[1]


def test_boundaries_are_drawn_inside_the_map(maps):
    """Curves that leave the map come in again: each flutter island has its outline."""
    figure = fig06.draw(maps["stability"], maps["quasi_static"], maps["boundaries"])
    axes = figure.axes[0]
    lines = [line for line in axes.get_lines() if line.get_color() == "#0072B2"]
    drawn = np.concatenate([line.get_xydata() for line in lines])
    for centre in ((0.14, 0.23), (0.77, 0.86)):
        gap = np.hypot(*(drawn / np.pi - centre).T)
        assert gap.min() < 0.06


def test_comparison_counts_every_cell_once():
    cells = {"regime_linear": [0, 0, 1, 2], "separates": [False, True, True, False]}
    validity = xr.Dataset(
        {name: (("a", "b"), [values] * 2) for name, values in cells.items()}
    )
    np.testing.assert_array_equal(fig07.kinds_of_cells(validity), [[2, 0, 1, 3]] * 2)


def test_round_off_of_a_critical_friction_is_not_drawn():
    """Opposite springs: it is the same with any dashpots."""
    pad = FORMER.with_(length1=0.02 / 2e-5, length2=0.02 / 2e-5, k3=0.7)
    dashpots = np.linspace(0.0, 0.1, 5)
    angles = np.linspace(0.0, np.pi, 5)
    figure = critical_friction.draw(
        critical.critical_friction_map(
            pad.with_(damping1=0.02, damping2=0.01), angles, angles
        ),
        critical.critical_damping_map(
            pad, np.radians(35.0), np.radians(145.0), dashpots, dashpots
        ),
    )
    assert figure.axes[2].texts[0].get_text() == "1.43\nwith any dashpots"
