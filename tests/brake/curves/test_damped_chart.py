"""Charts and boundaries of brakes with dashpots and laws of the user's own."""

import numpy as np
import pytest

from squealpipe import Parameters, contact_boundary, regime_chart
from squealpipe.brake.curves.stability import REGIME_GRID
from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.schema.curves import ChartLine
from squealpipe.codes import LinearRegime
from squealpipe.schema import Outcome
from tests.samples import some

T_END = 3.0
LAWS = ("exponential", "hyperbolic", "table", "python")


def random_brake(seed):
    """A brake with dashpots and a falling law, and two ranges."""
    rng = np.random.default_rng(seed)
    law = LAWS[seed % len(LAWS)]
    mu = rng.uniform(0.1, 0.5)
    static = mu * rng.uniform(1.1, 2.5)
    numbers = {
        "k2": rng.uniform(0.5, 2.0),
        "k3": rng.uniform(0.3, 1.5),
        "damping1": rng.uniform(0.0, 0.3),
        "damping2": rng.uniform(0.0, 0.3),
        "belt_speed": rng.uniform(0.2, 3.0) * rng.choice([-1.0, 1.0]),
        "length1": rng.uniform(5.0, 50.0),
        "length2": rng.uniform(5.0, 50.0),
    }
    own = {
        "table": f"cubic 0:{static} 0.7:{0.6 * static + 0.4 * mu} 3:{mu}",
        "python": "def coefficient(speed, p):\n"
        f"    return p.mu * (1 + {static / mu - 1} / (1 + speed * speed))\n",
    }
    friction = {"friction_law": own.get(law, law)}
    if law != "table":
        friction["mu"] = mu
    if law not in own:
        friction |= {"mu_static": static, "friction_speed": rng.uniform(0.3, 3.0)}
    angles = rng.uniform(0.0, np.pi, 2)
    both = np.linspace(0.0, np.pi, 9)
    ranges = (
        {"alpha1": both, "alpha2": both},
        {"belt_speed": np.linspace(0.1, 3.0, 9), "kappa": np.linspace(0.2, 1.5, 9)},
        {"alpha2": both, "damping1": np.linspace(0.0, 0.4, 9)},
    )[seed % 3]
    fixed = dict(zip(("alpha1", "alpha2"), angles, strict=True))
    return Parameters(**numbers, **friction), {**fixed, **ranges}


def crossed(chart):
    """Whether a line passes through, or beside, each of the chart's cells."""
    low, high = chart.range.values.T
    line = np.stack([chart[str(name)].values for name in chart.parameter.values], 1)
    line = (line - low) / (high - low) * REGIME_GRID
    cells = np.zeros((REGIME_GRID, REGIME_GRID), bool)
    same = np.diff(chart.curve.values) == 0
    for start, end in zip(line[:-1][same], line[1:][same], strict=True):
        steps = int(np.ceil(np.abs(end - start).max() * 20)) + 2
        along = start + np.linspace(0.0, 1.0, steps)[:, None] * (end - start)
        for shift in (-1e-3, 1e-3):
            at = np.clip((along + shift).astype(int), 0, REGIME_GRID - 1)
            cells[at[:, 0], at[:, 1]] = True
    return cells


def places(chart, axes, params, rng, count):
    """(row, column, parameters, angles) at random places of cells that no line crosses."""
    names = [str(name) for name in chart.parameter.values]
    low, high = chart.range.values.T
    free = np.argwhere(~crossed(chart))
    for cell in free[rng.choice(len(free), count)]:
        place = low + (high - low) * (cell + rng.uniform(0.02, 0.98, 2)) / REGIME_GRID
        yield tuple(cell), *design(place, names, axes, params)


def design(place, names, axes, params):
    """Parameters and angles at a place."""
    values = dict(zip(names, map(float, place), strict=True))
    angles = [[values.pop(name, axes[name])] for name in ("alpha1", "alpha2")]
    if "kappa" in values:
        values["k3"] = values.pop("kappa") * params.k1
    return params.with_(**values), angles


@pytest.mark.parametrize(
    ("seed", "cells"),
    [
        (2, 25),
        pytest.param(2, 50, marks=pytest.mark.release),
        *(pytest.param(i, 300, marks=pytest.mark.release) for i in some(range(20))),
    ],
)
def test_charts_of_random_damped_brakes_are_their_maps_and_runs(seed, cells):
    params, axes = random_brake(seed)
    chart = regime_chart(params, **axes, t_end=T_END)
    assert (chart.outcome == Outcome.converged).all(), dict(chart.outcome.to_series())
    rng = np.random.default_rng(seed)
    for cell, there, angles in places(chart, axes, params, rng, cells):
        found = stability_map(there, *angles).regime_linear.item()
        assert found == chart.cell_regime.values[cell], (cell, there, angles)
    for cell, there, angles in places(chart, axes, params, rng, 25):
        lost = bool(validity_map(there, *angles, t_end=T_END).separates.item())
        assert lost != chart.cell_kept.values[cell], (cell, there, angles)


def beside(boundary, rng, count):
    """Places 1e-5 of the ranges to the left and to the right of a boundary, (2, count, 2)."""
    low, high = boundary.range.values.T
    line = np.stack([boundary[str(name)].values for name in boundary.parameter.values])
    line = (line.T - low) / (high - low)
    ahead = np.diff(line, axis=0)
    length = np.where(np.diff(boundary.curve.values) == 0, np.hypot(*ahead.T), 0.0)
    at = np.searchsorted(
        np.cumsum(length), rng.uniform(0.05, 0.95, count) * length.sum()
    )
    left = 1e-5 * ahead[at, ::-1] * [-1.0, 1.0] / length[at, None]
    middle = line[at] + rng.uniform(0.0, 1.0, (count, 1)) * ahead[at]
    sides = np.clip(np.stack([middle + left, middle - left]), 0.0, 1.0)
    return low + sides * (high - low)


@pytest.mark.release
@pytest.mark.parametrize("seed", [3, 5, 7, 18])
def test_boundaries_of_random_damped_brakes_part_their_runs(seed):
    """Contact is kept on the left of each line and lost on its right."""
    params, axes = random_brake(seed)
    boundary = contact_boundary(params, **axes, t_end=T_END)
    assert boundary.outcome == Outcome.converged
    names = [str(name) for name in boundary.parameter.values]
    sides = beside(boundary, np.random.default_rng(seed), 25)
    for right, places in enumerate(sides):
        for place in places:
            there, angles = design(place, names, axes, params)
            lost = validity_map(there, *angles, t_end=T_END).separates.item()
            assert lost == right, (there, angles)


@pytest.mark.release
@pytest.mark.parametrize(
    "change",
    [
        {"damping1": 0.3},
        pytest.param(
            {"friction_law": "exponential", "mu_static": 0.6, "belt_speed": 1.0},
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_chart_over_the_angles_has_the_regimes_of_the_map(change):
    params = Parameters(**change)
    ends = np.linspace(0.0, np.pi, 5)
    chart = regime_chart(params, ends, ends, t_end=1.0)
    middles = (np.arange(REGIME_GRID) + 0.5) * np.pi / REGIME_GRID
    regimes = stability_map(params, middles, middles).regime_linear.values
    assert np.count_nonzero(regimes != chart.cell_regime.values) == 0
    assert set(np.unique(regimes)) >= {LinearRegime.stable, LinearRegime.flutter}
    # the regime is another one on either side of each line, 1e-5 away
    for which in (ChartLine.flutter, ChartLine.divergence):
        line = chart.isel(point=chart.line.values == which)
        places = np.stack([line.alpha1.values, line.alpha2.values], axis=1)
        ahead = np.diff(places, axis=0)
        length = np.where(np.diff(line.curve.values) == 0, np.hypot(*ahead.T), 0.0)
        at = np.searchsorted(
            np.cumsum(length), np.linspace(0.01, 0.99, 40) * length.sum()
        )
        aside = 1e-5 * ahead[at, ::-1] * [1.0, -1.0] / length[at, None]
        regimes = [
            [
                stability_map(
                    params, *(place + sign * way)[:, None]
                ).regime_linear.item()
                for sign in (1.0, -1.0)
            ]
            for place, way in zip(places[at], aside, strict=True)
        ]
        differ = (np.array(regimes) == LinearRegime[which.name]).sum(axis=1) == 1
        assert differ.mean() > 0.9


@pytest.mark.parametrize(
    ("change", "ranges", "why"),
    [
        ({}, {"friction_speed": np.linspace(1, 2, 3)}, "friction_speed cannot vary"),
        ({}, {"damping3": np.linspace(0, 1, 3)}, "damping3 cannot vary"),
        (
            {"friction_law": "linear 0:0.5 1:0.3"},
            {"mu": np.linspace(0.1, 0.4, 3)},
            "mu cannot vary.*law stands for it",
        ),
        (
            {"contact_law": "linear 0:0 1:1"},
            {"belt_speed": np.linspace(1, 2, 3)},
            "contact_law = 'linear 0:0 1:1'.*validity_map",
        ),
    ],
)
def test_what_cannot_be_charted_is_refused_by_its_name(change, ranges, why):
    params = Parameters(**change)
    for task in (regime_chart, contact_boundary):
        with pytest.raises(ValueError, match=why):
            task(params, np.linspace(0.0, 1.0, 3), 1.0, **ranges)


def test_friction_as_printed_is_that_of_a_formula():
    params = Parameters(friction_law="linear 0:0.5 1:0.3")
    ends = np.linspace(0.0, 1.0, 3)
    with pytest.raises(ValueError, match=r"friction_law = .*as printed"):
        contact_boundary(params, ends, ends, model="A1-as-printed")


def test_a_contact_that_pulls_is_the_same_until_contact_is_lost():
    params = random_brake(2)[0].with_(k3=1.4)
    times = np.linspace(0.0, 20.0, 401)
    runs = [
        simulate(params, 2.6, 2.6, t_end=20.0, times=times, model=model)
        for model in ("A1", "A1-no-separation")
    ]
    assert float(runs[1].normal_force.min()) < 0.0
    before = times < float(runs[0].event_time[runs[0].event_kind == 0][0])
    assert before.sum() > 10
    np.testing.assert_allclose(
        runs[0].x.values[before], runs[1].x.values[before], atol=1e-11
    )
