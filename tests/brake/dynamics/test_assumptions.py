"""What the levels take for granted, against closed forms, bounds and each other."""

import numpy as np
import pytest

from squealpipe.brake.dynamics.assumptions import (
    ASSUMED_BY_LEVEL,
    ASSUMPTION_LEVELS,
    check_assumptions,
    linear_pull_map,
)
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.parameters import SCENES
from tests.former import FORMER

DECOUPLED = ("F2a", "F2b", "F2c")
"""Scenes whose spring stiffness is k times the identity."""


@pytest.fixture(scope="module")
def table():
    return check_assumptions(FORMER)


def measure(table, level, scene, assumption):
    return float(table.measure.sel(level=level, scene=scene, assumption=assumption))


def test_the_linear_contact_pulls_where_the_real_one_lets_go(table):
    lowest = table.measure.sel(assumption="contact is kept")
    for scene in ("F2d", "F3", "F4", "F5a", "F13"):
        assert float(lowest.sel(level="A3", scene=scene)) < 0
        assert float(lowest.sel(level="A1", scene=scene)) == 0
        assert float(lowest.sel(level="A1-no-separation", scene=scene)) < 0


def test_without_separation_nothing_changes_where_contact_is_kept(table):
    lowest = table.measure.sel(assumption="contact is kept")
    for values in (table.largest_x, table.largest_y, lowest):
        pair = values.sel(scene=list(DECOUPLED), level=["A1", "A1-no-separation"])
        np.testing.assert_allclose(pair[0], pair[1], rtol=1e-9)


def test_turn_of_a_spring_is_that_of_the_motion(table):
    """At F5a both springs lie along x, so the largest turn follows from the highest point."""
    p, scene = FORMER, SCENES["F5a"]
    times = np.linspace(0.0, scene.t_end, 200_001)
    run = simulate(p, scene.alpha1, scene.alpha2, t_end=scene.t_end, times=times)
    turns = [
        np.abs(np.arctan2(run.y, p.length1 + side * run.x)).max() for side in (-1, 1)
    ]
    assert measure(table, "A1", "F5a", "angles are constant") == pytest.approx(
        float(max(turns)), rel=1e-5
    )


def test_longer_springs_turn_less_and_are_more_linear():
    short, long = (
        check_assumptions(FORMER.with_(length1=length, length2=length), [SCENES["F2a"]])
        for length in (5.0, 500.0)
    )
    for name in ("angles are constant", "springs are linear"):
        small, large = (measure(table, "A1", "F2a", name) for table in (long, short))
        assert small < 0.02 * large


def test_each_level_needs_what_the_paper_lists(table):
    assert list(table.level.values) == list(ASSUMPTION_LEVELS)
    for level in ASSUMPTION_LEVELS:
        needed = table.assumption.values[table.needed.sel(level=level).values == 1]
        assert set(needed) == set(ASSUMED_BY_LEVEL[level])


def test_linear_pull_map_is_the_closed_form_where_x_and_y_are_decoupled():
    kappa = FORMER.kappa
    pull = linear_pull_map(
        FORMER, [0.5 * np.pi, np.pi], [0.5 * np.pi, np.pi], t_end=50.0
    )
    lowest = pull.lowest_contact_force.values
    # Springs along x: y'' = k3 (l_pre − y)/m, so the force is l_pre k3 cos(√(k3/m) t).
    exact = [(1 - kappa) / (1 + kappa), (1 - kappa) / (1 + kappa), -1.0]
    np.testing.assert_allclose(lowest[[0, 1, 1], [1, 0, 1]], exact, atol=2e-6)
    assert float(pull.pulling_fraction[1, 1]) == pytest.approx(0.5, abs=0.03)
