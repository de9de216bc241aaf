"""Figures of the dynamics show what their datasets hold, also where a part of it is empty."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import FancyArrowPatch

from squealpipe.brake.curves.contact import boundary_distance, contact_boundary
from squealpipe.brake.dynamics import hammering as hammering_task
from squealpipe.brake.dynamics import refinement
from squealpipe.brake.dynamics import runs as dynamics
from squealpipe.brake.dynamics import whirl as whirl_task
from squealpipe.paper.figures.dynamics import (
    fig02,
    fig03,
    fig04,
    fig05,
    hammering_map,
    predictability,
    refined_boundary,
    whirl,
)
from squealpipe.paper.figures.linear import fig07
from squealpipe.parameters import SCENES, Parameters
from squealpipe.plotting.mechanism import draw_mechanism
from squealpipe.plotting.style import new_figure, save_figure
from tests.former import FORMER

ANGLES = np.linspace(0, np.pi, 16)
STUDIES = {
    "never separates": Parameters(k3=1e-3),
    "always separates": Parameters(k3=50.0, belt_speed=-2.0),
    "belt at rest": Parameters(belt_speed=0.0),
}


def scene(name, params):
    chosen = SCENES[name]
    return dynamics.simulate(params, chosen.alpha1, chosen.alpha2, t_end=chosen.t_end)


@pytest.mark.release
@pytest.mark.parametrize("params", STUDIES.values(), ids=STUDIES)
def test_all_are_drawn_for_any_study(params, tmp_path):
    validity = dynamics.validity_map(params, ANGLES, ANGLES, t_end=50.0)
    hammering = hammering_task.hammering_map(params, ANGLES, ANGLES, t_end=20.0)
    refined = refinement.refine_validity_map(
        params, resolution=61, coarse=16, t_end=50.0
    )
    sizes = whirl_task.whirl_sizes(params, [0.5, 5.0, 50.0], t_end=100.0)
    boundary = contact_boundary(params, ANGLES, ANGLES, t_end=10.0)
    distance = boundary_distance(boundary, {"alpha1": 0.3, "alpha2": 0.9})
    of_fig07 = {"validity_map": validity, "validity_boundary": boundary}
    of_fig07 |= {"validity_distance/F3": distance}
    runs = {
        name: scene(name, params)
        for name in ("F2a", "F2b", "F2c", "F2d", "F3", "F4", "F5a")
    }
    figures = {
        "fig02": fig02.draw(*list(runs.values())[:4]),
        "fig03": fig03.draw({"simulate/F3": runs["F3"]}),
        "fig04": fig04.draw(runs["F4"]),
        "fig05": fig05.draw(runs["F5a"], runs["F5a"]),
        "fig07": fig07.draw(of_fig07),
        "hammering": hammering_map.draw(hammering),
        "predictability": predictability.draw(hammering),
        "refined": refined_boundary.draw(refined, boundary),
        "whirl": whirl.draw(runs["F3"], sizes),
    }
    assert "nan" not in fig07.caption(of_fig07)
    for name, figure in figures.items():
        save_figure(figure, [tmp_path / f"{name}.png"])
        assert (tmp_path / f"{name}.png").stat().st_size > 5000


def test_fig07_tones():
    validity = dynamics.validity_map(FORMER, ANGLES, ANGLES, t_end=50.0)
    grown = validity.response_growth.copy()
    kept = validity.separates.values == 0
    grown.values[kept] = np.where(np.arange(kept.sum()) % 2, 3.0, 1.0)
    figure = fig07.draw({"validity_map": validity.assign(response_growth=grown)})
    tones = np.asarray(figure.axes[0].images[0].get_array()).T
    np.testing.assert_array_equal(
        tones == 3, kept & (validity.regime_linear.values > 0)
    )
    np.testing.assert_array_equal(tones < 2, ~kept)
    assert (
        fig07.grows(validity.assign(response_growth=grown)) == (grown.values > 1.5)
    ).all()
    maps = {"corrected/validity_map": validity, "validity_map": validity}
    assert "(a) as printed; (b) one sign" in fig07.caption(maps)
    both = fig07.draw(maps)
    titles = [axes.get_title(loc="left") for axes in both.axes]
    assert "as printed" in titles[0]
    assert "one sign" in titles[1]


def test_separated_spells_are_marked_where_the_force_is_zero():
    run = scene("F2d", FORMER)
    figure = fig02.draw(run, run, run, run)
    line = figure.axes[0].get_lines()[0]
    np.testing.assert_array_equal(line.get_ydata(), run.normalized_contact_force)
    assert run.normalized_contact_force.values[run.regime.values == 3].max() == 0.0


def test_the_arrow_of_the_belt_points_where_it_runs():
    for direction in (1.0, -1.0):
        _, axes = new_figure(2.0, 2.0)
        draw_mechanism(axes[0, 0], 0.3 * np.pi, 0.2 * np.pi, direction=direction)
        (arrow,) = (
            part for part in axes[0, 0].patches if isinstance(part, FancyArrowPatch)
        )
        assert direction * arrow.get_path().vertices[:, 0].mean() > 0


@pytest.mark.parametrize("tip", [(30, 60), (150, 140)])
def test_the_window_is_where_the_boundary_is_most_intricate(tip):
    """Contact is kept below a straight line, and in a horn three cells wide above it."""
    rows, columns = np.indices((181, 181))
    horn = (abs(rows - tip[0]) <= 1) & (columns < tip[1]) & (columns > tip[1] - 20)
    kept = (columns < tip[1] - 15) | horn
    angles = np.linspace(0, np.pi, 181)
    map_ = xr.Dataset(
        {"separates": (("alpha1", "alpha2"), (~kept).astype("i1"))},
        {"alpha1": angles, "alpha2": angles},
    )
    low1, high1, low2, high2 = refined_boundary._intricate(map_)
    assert low1 < angles[tip[0]] < high1
    assert low2 < angles[tip[1]] < high2
    assert high1 - low1 == pytest.approx(
        refined_boundary.WINDOW_SHARE * np.pi, rel=0.06
    )
