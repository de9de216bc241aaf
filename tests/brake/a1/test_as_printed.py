"""Friction as Eq. (4) prints it, against DOP853."""

import numpy as np
import pytest

from squealpipe import Parameters, simulate
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.parameters import SCENES
from tests.oracles.a1_automaton import EventKind
from tests.oracles.a1_scipy import simulate_scipy

PAPER = Parameters(k3=0.65, mu=0.3, belt_speed=100.0, length1=15.0, length2=15.0)
PAD = Parameters(
    mass=0.5,
    k1=1e7,
    k2=2e7,
    k3=7e6,
    mu=0.3,
    preload=1e-4,
    length1=1e-3,
    length2=2e-3,
    belt_speed=0.1,
)


@pytest.mark.parametrize(
    ("params", "start", "least"),
    [
        (PAPER.with_(belt_speed=0.4), (0.0, 0.2, 0.6, 0.0), 1),
        (PAPER.with_(belt_speed=-0.4, k2=1.3), (0.0, -0.3, 0.1, 0.0), 1),
        (PAD, (0.0, 0.0, 0.15, 0.0), 1),
        (PAPER, (0.0, 0.0, 0.0, 0.0), 0),
    ],
)
def test_state_and_crossings_of_belt_speed(params, start, least):
    t_end = 12.0 * params.time_unit
    run = simulate(
        params,
        0.9,
        2.0,
        t_end=t_end,
        model="A1-as-printed",
        initial_state=start,
        times=[t_end],
    )
    given = {"t_end": t_end, "initial_state": start, "tol": 1e-14 * params.preload}
    exact = simulate_scipy(params, 0.9, 2.0, as_printed=True, **given)
    crossings = exact.event_kinds.count(EventKind.belt_speed)
    found = np.array([run[name].item() for name in ("x", "y", "vx", "vy")])
    unit = params.preload * np.array([1, 1, 1 / params.time_unit, 1 / params.time_unit])
    np.testing.assert_allclose(found / unit, exact.state / unit, atol=1e-9)
    assert int((run.event_kind == 4).sum()) == crossings >= least


def test_fig_3_grows_without_bound_and_fig_4_does_not():
    """|x| by an independent DOP853 run, whose orbit chaos makes another one after T = 100."""
    third, fourth = SCENES["F3"], SCENES["F4"]
    times = [500.0, 600.0, 1200.0, 1800.0, 3000.0]
    growing = run_ensemble(
        PAPER,
        third.alpha1,
        third.alpha2,
        t_end=times,
        model="A1-as-printed",
        t_late=0.0,
    )
    np.testing.assert_allclose(growing.late_max_x, [48, 106, 555, 829, 1212], rtol=0.05)
    bounded = run_ensemble(
        PAPER,
        fourth.alpha1,
        fourth.alpha2,
        t_end=500.0,
        model="A1-as-printed",
        t_late=0.0,
    )
    assert bounded.late_max_x == pytest.approx(27, rel=0.03)


def test_it_is_a_belt_the_other_way_while_slower():
    scene = SCENES["F2d"]
    runs = [
        simulate(
            PAPER.with_(belt_speed=speed),
            scene.alpha1,
            scene.alpha2,
            t_end=50.0,
            model=model,
        )
        for speed, model in ((100.0, "A1-as-printed"), (-100.0, "A1"))
    ]
    for name in ("x", "y", "normal_force"):
        np.testing.assert_allclose(runs[0][name], runs[1][name], atol=1e-12)
