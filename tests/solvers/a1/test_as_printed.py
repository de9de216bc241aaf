"""Friction as Eq. (4) prints it, against equations of its own under DOP853."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe import Parameters, simulate
from squealpipe.parameters import SCENES
from squealpipe.solvers.a1.ensemble import run_ensemble

PAPER = Parameters(k3=0.65, mu=0.3, belt_speed=100.0, length1=15.0, length2=15.0)


def dop853(p, alpha1, alpha2, t_end, start):
    """The state at ``t_end`` and how often ẋ crossed V in contact."""
    pivots = p.length1 * np.array([np.cos(alpha1), np.sin(alpha1)])
    pivots = (pivots, p.length2 * np.array([-np.cos(alpha2), np.sin(alpha2)]))

    def rates(_, z, contact, faster):
        force = np.zeros(2)
        for k, length, pivot in zip((p.k1, p.k2), (p.length1, p.length2), pivots, strict=True):
            arm = z[:2] - pivot
            force -= k * (1.0 - length / np.hypot(*arm)) * arm
        normal = contact * p.k3 * (p.preload - z[1])
        return [z[2], z[3], (force[0] + faster * p.mu * normal) / p.mass,
                (force[1] + normal) / p.mass]  # fmt: skip

    def gap(_, z, *__):
        return z[1] - p.preload

    def speed(_, z, contact, __):
        return z[2] - p.belt_speed if contact else 1.0

    gap.terminal = speed.terminal = True
    time, z, contact, crossings = 0.0, np.array(start, float), 1.0, 0
    faster = float(np.sign(z[2] - p.belt_speed))
    while True:
        gap.direction, speed.direction = (1 if contact else -1), -faster
        run = solve_ivp(
            rates, (time, t_end), z, method="DOP853", rtol=1e-13, atol=1e-14 * p.preload,
            events=(gap, speed), args=(contact, faster), max_step=0.02 * t_end,
        )  # fmt: skip
        time, z = run.t[-1], run.y[:, -1]
        if run.status == 0:
            return z, crossings
        if run.t_events[0].size:
            contact = 1.0 - contact
            faster = float(np.sign(z[2] - p.belt_speed))
        else:
            faster, crossings = -faster, crossings + 1


@pytest.mark.parametrize(
    ("params", "start", "least"),
    [
        (PAPER.with_(belt_speed=0.4), (0.0, 0.2, 0.6, 0.0), 1),
        (PAPER.with_(belt_speed=-0.4, k2=1.3), (0.0, -0.3, 0.1, 0.0), 1),
        (
            Parameters(
                mass=0.5,
                k1=1e7,
                k2=2e7,
                k3=7e6,
                mu=0.3,
                preload=1e-4,
                length1=1e-3,
                length2=2e-3,
                belt_speed=0.1,
            ),
            (0.0, 0.0, 0.15, 0.0),
            1,
        ),
        (PAPER, (0.0, 0.0, 0.0, 0.0), 0),
    ],
)
def test_state_and_crossings_of_belt_speed(params, start, least):
    t_end = 12.0 * params.time_unit
    run = simulate(
        params, 0.9, 2.0, t_end=t_end, model="A1-as-printed", initial_state=start, times=[t_end]
    )
    z, crossings = dop853(params, 0.9, 2.0, t_end, start)
    found = np.array([run[name].item() for name in ("x", "y", "vx", "vy")])
    unit = params.preload * np.array([1, 1, 1 / params.time_unit, 1 / params.time_unit])
    np.testing.assert_allclose(found / unit, z / unit, atol=1e-9)
    assert int((run.event_kind == 4).sum()) == crossings >= least


def test_fig_3_grows_without_bound_and_fig_4_does_not():
    """|x| by an independent DOP853 run, whose orbit chaos makes another one after T = 100."""
    third, fourth = SCENES["F3"], SCENES["F4"]
    times = [500.0, 600.0, 1200.0, 1800.0, 3000.0]
    growing = run_ensemble(
        PAPER, third.alpha1, third.alpha2, t_end=times, model="A1-as-printed", t_late=0.0
    )
    np.testing.assert_allclose(growing.late_max_x, [48, 106, 555, 829, 1212], rtol=0.05)
    bounded = run_ensemble(
        PAPER, fourth.alpha1, fourth.alpha2, t_end=500.0, model="A1-as-printed", t_late=0.0
    )
    assert bounded.late_max_x == pytest.approx(27, rel=0.03)


def test_it_is_a_belt_the_other_way_while_slower():
    scene = SCENES["F2d"]
    runs = [
        simulate(PAPER.with_(belt_speed=speed), scene.alpha1, scene.alpha2, t_end=50.0, model=model)
        for speed, model in ((100.0, "A1-as-printed"), (-100.0, "A1"))
    ]
    for name in ("x", "y", "normal_force"):
        np.testing.assert_allclose(runs[0][name], runs[1][name], atol=1e-12)
