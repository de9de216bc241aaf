"""The regime chart: its lines against closed forms, its regions against runs in them."""

import json

import numpy as np
import pytest

import squealpipe
from squealpipe.brake.models import a3
from squealpipe.brake.schema.curves import ChartLine
from squealpipe.codes import LinearRegime
from squealpipe.parameters import Parameters

PARAMS = Parameters(length1=15.0, length2=15.0)
ANGLES = np.linspace(0.0, np.pi, 31)


@pytest.fixture(scope="module")
def chart():
    design = {
        "alpha1": np.pi * np.array([0.305, 0.83]),
        "alpha2": np.pi * np.array([0.07, 0.83]),
    }
    return squealpipe.regime_chart(PARAMS, ANGLES, ANGLES, design=design, t_end=15.0)


def test_linear_lines_are_circles_of_the_plane(chart):
    z = a3.plane(PARAMS, chart.alpha1.values, chart.alpha2.values)
    for which, circle in (
        (ChartLine.flutter, a3.flutter_circle),
        (ChartLine.divergence, a3.divergence_circle),
    ):
        on = chart.line.values == which
        centre, radius = circle(PARAMS, PARAMS.k3)
        assert on.any()
        np.testing.assert_allclose(np.abs(z[on] - centre), radius, atol=1e-8)


def test_regions_are_what_runs_and_eigenvalues_say(chart):
    places = chart.region_place.values
    assert float(chart.region_share.sum()) == pytest.approx(1.0, abs=1e-12)
    for place, regime, kept in zip(
        places, chart.region_regime.values, chart.region_kept.values, strict=True
    ):
        here = squealpipe.stability_map(PARAMS, place[:1], place[1:])
        run = squealpipe.validity_map(PARAMS, place[:1], place[1:], t_end=15.0)
        assert int(here.regime_linear.item()) == regime
        assert bool(run.separates.item()) != bool(kept)
    assert set(chart.region_regime.values) == set(LinearRegime)


@pytest.mark.release
def test_distances_of_a_design(chart):
    """From points of the closed forms' lines, and from the boundary on a finer grid."""
    fine = np.linspace(0.0, np.pi, 61)
    boundary = squealpipe.contact_boundary(PARAMS, fine, fine, t_end=15.0)
    for design, (*linear, contact) in zip(
        chart.design.values, chart.distance.values, strict=True
    ):
        at = dict(zip(("alpha1", "alpha2"), design, strict=True))
        finer = squealpipe.boundary_distance(boundary, at).distance
        assert contact == pytest.approx(float(finer), abs=5e-6)
        for which, distance in zip(ChartLine, linear, strict=False):
            on = chart.line.values == which
            far = np.hypot(chart.alpha1[on] - design[0], chart.alpha2[on] - design[1])
            assert distance == pytest.approx(float(far.min()), abs=2e-4)
            assert distance < float(far.min()) + 1e-12


def test_runs_a_millionth_beside_the_line_answer_otherwise(chart):
    """For less than a hundredth of the runs of a grid that resolves a thousandth of the ranges."""
    assert int(chart.runs) < 0.01 * 1000**2
    on = np.flatnonzero(chart.line.values == ChartLine.contact_lost)
    for point in on[5 : -5 : len(on) // 15]:
        beside = []
        for sign in (-1.0, 1.0):
            ends = chart.isel(point=[point - 1, point + 1])
            along = np.array([np.diff(ends.alpha1)[0], np.diff(ends.alpha2)[0]])
            aside = (
                sign * 1e-6 * np.pi * along[::-1] * [-1.0, 1.0] / np.linalg.norm(along)
            )
            here = chart.isel(point=[point])
            angles = here.alpha1.values + aside[0], here.alpha2.values + aside[1]
            run = squealpipe.validity_map(PARAMS, *angles, t_end=15.0)
            beside.append(bool(run.separates.item()))
        assert (
            beside == [True, False] or chart.curve[point - 1] != chart.curve[point + 1]
        )


def test_parameters_under_their_own_names():
    """The design is that of the parameters; flutter begins on a circle for each κ."""
    kappa, mu = np.linspace(0.3, 1.3, 9), np.linspace(0.02, 0.8, 9)
    angles = 0.4 * np.pi, 0.1 * np.pi
    chart = squealpipe.regime_chart(PARAMS, *angles, t_end=10.0, kappa=kappa, mu=mu)
    assert chart.design.values.tolist() == [[PARAMS.kappa, PARAMS.mu]]
    assert (
        int(chart.runs) < 0.01 * 1000**2
    )  # a uniform grid that resolves as much as a thousandth
    on = chart.line.values == ChartLine.flutter
    for k, m in zip(chart.kappa.values[on], chart.mu.values[on], strict=True):
        there = PARAMS.with_(k3=float(k), mu=float(m))
        centre, radius = a3.flutter_circle(there, there.k3)
        assert abs(a3.plane(there, *angles) - centre) == pytest.approx(radius, abs=1e-8)
    with pytest.raises(ValueError, match="kappa and mu are needed"):
        squealpipe.regime_chart(
            PARAMS, *angles, t_end=10.0, design={"kappa": 1.0}, kappa=kappa, mu=mu
        )


@pytest.mark.release
def test_onset_of_the_whirl_and_of_its_stick():
    """Along the friction of the design the distances are those to the branch's special points."""
    params = PARAMS.with_(mu=0.15, belt_speed=-100.0, damping1=0.02, damping2=0.02)
    angles, kappa, mu = (
        (0.4 * np.pi, 0.6 * np.pi),
        np.linspace(0.6, 0.7, 5),
        np.linspace(0, 0.3, 5),
    )
    start = squealpipe.limit_cycle(params.with_(mu=0.3), *angles, t_settle=6000.0)
    scene = params.with_(mu=0.3), *angles
    branch = squealpipe.cycle_branch(*scene, parameter="mu", to=0.003, start=start)
    whirl, stick = (
        squealpipe.cycle_curve(
            *scene,
            label=label,
            parameters=("mu", "k3"),
            start=branch,
            to={"k3": (0.6, 0.7)},
            n_points=400,
        )
        for label in ("fold", "stick_onset")
    )
    chart = squealpipe.regime_chart(
        params, *angles, t_end=5.0, kappa=kappa, mu=mu, whirl=whirl, stick=stick
    )
    assert chart.boundary.values[3:].tolist() == ["whirl", "stick"]
    for which, curve in (("whirl", whirl), ("stick", stick)):
        on = chart.line.values == ChartLine[which]
        np.testing.assert_array_equal(chart.mu[on], curve.mu)
        far = float(np.hypot(curve.k3 - params.k3, curve.mu - params.mu).min())
        assert float(chart.distance[0, ChartLine[which]]) <= far
    short = squealpipe.regime_chart(
        params, *angles, t_end=5.0, kappa=kappa, mu=mu, whirl=[], stick=[whirl, stick]
    )
    assert short.distance[0, 3:].values.tolist() == [
        np.inf,
        min(chart.distance[0, 3:].values),
    ]
    assert short.attrs["parameters"] == chart.attrs["parameters"]
    assert json.loads(short.attrs["parameters"])["mu"] == params.mu
    fold = float(branch.mu[branch.label == 1][0])
    assert (
        float(chart.distance[0, 3])
        <= params.mu - fold
        < 1.05 * float(chart.distance[0, 3])
    )
    with pytest.raises(ValueError, match="in k3 and belt_speed is needed"):
        squealpipe.regime_chart(
            params, *angles, kappa=kappa, belt_speed=mu + 1.0, whirl=whirl
        )
