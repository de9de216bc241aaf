"""Extremes of runs lie between the instants that are stored; they come from the integrator."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.dynamics.summary import summarize
from squealpipe.brake.schema.dynamics.extremes import EXTREMES, extremes, largest_size
from squealpipe.parameters import SCENES
from squealpipe.systems.integrate import RunOptions, integrate
from squealpipe.systems.shipped.bouncing_ball import bouncing_ball
from tests.former import FORMER
from tests.oracles.written import written

COARSE = np.linspace(0.0, 40.0, 61)
"""Fewer than seven instants a period."""


@pytest.fixture(scope="module")
def coarse():
    """Samples of a closed form that miss its extremes by a per cent."""
    scene = SCENES["F2a"]
    return simulate(
        FORMER, scene.alpha1, scene.alpha2, t_end=40.0, model="A4", times=COARSE
    )


def test_extremes_of_a_closed_form_are_met_however_coarse_the_samples(coarse):
    kappa, mu = FORMER.kappa, FORMER.mu
    high = 2.0 * kappa / (1.0 + kappa)
    assert coarse.y.max() < 0.9999 * high
    _, largest = extremes(coarse, "y")
    assert largest.max() == pytest.approx(high, rel=1e-12)
    assert largest_size(coarse, "x").max() == pytest.approx(mu * high, rel=1e-12)
    lowest, _ = extremes(coarse, "normalized_contact_force")
    assert lowest.min() == pytest.approx((1.0 - kappa) / (1.0 + kappa), rel=1e-11)
    omega = np.sqrt(1.0 + kappa)
    fastest = mu * omega * kappa / (1.0 + kappa)
    assert extremes(coarse, "vx")[1].max() == pytest.approx(fastest, rel=1e-11)
    distance = high * np.hypot(1.0, mu)
    assert float(coarse.max_displacement) == pytest.approx(distance, rel=1e-12)


def test_extremes_of_each_interval_are_those_of_the_closed_form(coarse):
    kappa = FORMER.kappa
    omega, middle = np.sqrt(1.0 + kappa), kappa / (1.0 + kappa)
    low, high = extremes(coarse, "y")
    for number, (begin, end) in enumerate(pairwise(COARSE)):
        turns = np.arange(np.ceil(omega * begin / np.pi), omega * end / np.pi)
        instants = np.array([begin, end, *(turns * np.pi / omega)])
        exact = middle * (1.0 - np.cos(omega * instants))
        found = low[number + 1], high[number + 1]
        np.testing.assert_allclose(found, (exact.min(), exact.max()), atol=1e-12)


FLIES, PLACE = FORMER.with_(mu=0.1), SCENES["F2d"]


@written
def extremes_apart(t_end):
    """Ranges of x, y and vx, and the largest displacement, by DOP853 with dense output.

    In the frame of A1's equations, written down here, kink by kink.
    """
    p, scene = FLIES, PLACE
    ends = np.array(
        [
            [p.length1 * np.cos(scene.alpha1), p.length1 * np.sin(scene.alpha1)],
            [-p.length2 * np.cos(scene.alpha2), p.length2 * np.sin(scene.alpha2)],
        ]
    )

    def field(t, state):
        force = np.zeros(2)
        for k, end, free in zip(
            (p.k1, p.k2), ends, (p.length1, p.length2), strict=True
        ):
            away = state[:2] - end
            distance = np.hypot(*away)
            force -= k * (distance - free) / distance * away
        normal = p.k3 * max(p.preload - state[1], 0.0)
        return [*state[2:], *((force + normal * np.array([p.mu, 1.0])) / p.mass)]

    peer = solve_ivp(
        field,
        (0.0, t_end),
        np.zeros(4),
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
        max_step=0.02,
        dense_output=True,
    )
    fine = peer.sol(np.linspace(0.0, t_end, 400_001))
    ranges = [(row.min(), row.max()) for row in fine[:3]]
    return ranges, np.hypot(fine[0], fine[1]).max()


def test_extremes_with_flights_agree_with_another_integrator():
    run = simulate(
        FLIES, PLACE.alpha1, PLACE.alpha2, t_end=20.0, times=np.linspace(0, 20, 21)
    )
    ranges, reach = extremes_apart(20.0)
    for name, (lowest, highest) in zip(("x", "y", "vx"), ranges, strict=True):
        low, high = extremes(run, name)
        assert np.nanmin(low) == pytest.approx(lowest, rel=1e-6)
        assert np.nanmax(high) == pytest.approx(highest, rel=1e-6)
    assert np.nanmin(extremes(run, "normalized_contact_force")[0]) == 0.0
    assert float(run.max_displacement) == pytest.approx(reach, rel=1e-6)


def test_extremes_do_not_depend_on_the_instants():
    scene = SCENES["F3"]
    found = [
        simulate(
            FORMER,
            scene.alpha1,
            scene.alpha2,
            t_end=100.0,
            times=np.linspace(0.0, 100.0, count),
        )
        for count in (101, 2001)
    ]
    for name in EXTREMES:
        low, high = np.array(
            [
                [each.min(), each.max()]
                for each in (np.array(extremes(run, name)) for run in found)
            ]
        ).T
        np.testing.assert_allclose(low, low[0], rtol=1e-10)
        np.testing.assert_allclose(high, high[0], rtol=1e-10)
    sizes = [float(summarize(run).largest_x) for run in found]
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-10)


def test_samples_lie_within_the_extremes_and_what_was_not_reached_has_none():
    scene = SCENES["F2d"]
    run = simulate(
        FORMER,
        scene.alpha1,
        scene.alpha2,
        t_end=30.0,
        model="A1-no-stick",
        initial_state=(0.0, 0.0, 99.9, 0.0),
    )
    for name in EXTREMES:
        low, high = extremes(run, name)
        values = run[name].values
        assert np.array_equal(np.isnan(low), np.isnan(values))
        assert (low[np.isfinite(low)] <= values[np.isfinite(low)]).all()
        assert (high[np.isfinite(low)] >= values[np.isfinite(low)]).all()


def test_files_of_version_1_have_their_samples(coarse):
    older = coarse.drop_vars(
        [f"{name}_{end}" for name in EXTREMES for end in ("min", "max")]
    )
    low, high = extremes(older, "y")
    assert np.array_equal(low, older.y.values)
    assert np.array_equal(high, older.y.values)


def test_a_ball_rises_between_the_instants_to_its_apex():
    """Drops from h; after each impact the apex is restitution² of the one before."""
    p = bouncing_ball.parameters
    drop = np.sqrt(2.0 / p["gravity"])
    times = np.array([drop, 1.5 * drop, drop + 2.0 * p["restitution"] * drop])
    values = {**bouncing_ball.start, **p}
    raw = integrate(
        bouncing_ball,
        {name: np.array([value]) for name, value in values.items()},
        np.array([times[-1] + 0.1 * drop]),
        RunOptions(times=times, tracked=["y"], extremes_between=True),
        tol=1e-12,
    )
    low, high = raw["sample_extremes"][0, :, 0].T
    assert high == pytest.approx(
        [1.0, raw["samples"][0, 1, 0], p["restitution"] ** 2], rel=1e-9
    )
    assert low == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
