"""A pad that slides dies out where its modes decay as linear ones do, and not elsewhere."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe.brake.assess.fading import Fading, dies_out
from squealpipe.brake.assess.settling import settle as settle_pads
from squealpipe.brake.assess.settling import start_at
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.parameters import Parameters

RATIO = 2e-5
PAD = Parameters(
    mass=0.45,
    k1=1e7,
    k2=1.4e7,
    k3=7e6,
    mu=0.2,
    preload=5e-4,
    belt_speed=3.0,
    length1=0.1,
    length2=0.1,
    damping1=2.0 * RATIO * np.sqrt(1e7 * 0.45),
    damping2=2.0 * RATIO * np.sqrt(1.4e7 * 0.45),
)
SLIDING = Sliding.of(Design(PAD, np.radians(70.0), np.radians(40.0)))
LENGTH = Fading.periods * SLIDING.design.period


def linear_motion(amplitude, jacobian=SLIDING.jacobian):
    """States of the linear motion in closed form from a displacement across the belt, m."""
    values, vectors = np.linalg.eig(jacobian)
    weights = np.linalg.solve(vectors, [0.0, amplitude, 0.0, 0.0])
    times = LENGTH * (np.arange(512) + 1) / 512
    waves = vectors @ (weights[:, None] * np.exp(np.outer(values, times)))
    return SLIDING.state + waves.real.T


def test_the_linear_motion_dies_out():
    assert dies_out(SLIDING, linear_motion(1e-5), LENGTH)


def test_one_that_reaches_the_edge_of_contact_is_not_shown():
    room = PAD.preload - SLIDING.state[1]
    assert dies_out(SLIDING, linear_motion(0.3 * room), LENGTH)
    assert not dies_out(SLIDING, linear_motion(1.05 * room), LENGTH)


@pytest.mark.parametrize("slower", [0.0, 0.5, -1.0])
def test_a_decay_other_than_that_of_small_motions_is_not_shown(slower):
    """As of a motion that nears a cycle from outside, holds its size, or grows."""
    undamped = SLIDING.jacobian.copy()
    undamped[2:, 2:] *= slower
    assert not dies_out(SLIDING, linear_motion(1e-5, undamped), LENGTH)


def test_what_is_shown_after_some_hundred_periods_holds_for_all_of_the_decay():
    """Another integrator follows the nonlinear springs until the motion is a tenth of the push."""
    # more damping, so that the decay is short enough to be followed
    factor = 160.0
    params = PAD.with_(damping1=PAD.damping1 * factor, damping2=PAD.damping2 * factor)
    design = Design(params, np.radians(70.0), np.radians(40.0))
    sliding = Sliding.of(design)
    state = sliding.state + np.array([0.0, 0.3 * params.preload, 0.0, 0.0])
    start = start_at(design, sliding, state)
    # A1's springs by their geometry alone, in contact, dragged along
    springs = (
        (params.k1, params.damping1, params.length1, design.alpha1),
        (params.k2, params.damping2, params.length2, np.pi - design.alpha2),
    )
    anchors = [
        (k, c, length, length * math.cos(angle), length * math.sin(angle))
        for k, c, length, angle in springs
    ]

    def field(_, now):
        x, y, vx, vy = now.tolist()
        normal = params.k3 * (params.preload - y)
        fx, fy = params.mu * normal, normal
        for k, c, length, ax, ay in anchors:
            long = math.hypot(x - ax, y - ay)
            ux, uy = (x - ax) / long, (y - ay) / long
            pull = k * (long - length) + c * (ux * vx + uy * vy)
            fx, fy = fx - pull * ux, fy - pull * uy
        return vx, vy, fx / params.mass, fy / params.mass

    end = np.log(start.distance(state) / (0.1 * start.speed)) / -start.rate
    run = solve_ivp(field, (0.0, end), state, method="DOP853", rtol=1e-9, atol=1e-13)
    assert run.y[1].max() < params.preload
    assert run.y[2].max() < params.belt_speed
    assert start.distance(run.y[:, -1]) < 0.2 * start.speed
    (settled,) = settle_pads([start], tol=1e-9)
    assert settled.quiet
    assert settled.last.fades


def test_a_slow_decay_costs_one_short_run():
    state = SLIDING.state + np.array([0.0, 0.2 * PAD.preload, 0.0, 0.0])
    start = start_at(SLIDING.design, SLIDING, state)
    assert -start.rate * start.period * 5000.0 < 1.5
    (settled,) = settle_pads([start], tol=1e-9)
    assert settled.quiet
    assert float(settled.last.length) == pytest.approx(LENGTH)
