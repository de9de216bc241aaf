"""Structures in motion against model A1, an integrator apart, and conserved quantities."""

import json

import numpy as np
import pytest

from squealpipe import Contact, Parameters, Structure, labels, simulate
from squealpipe.structures import elastic_pad

ANGLES = {
    ("exponential", None, 0.453, 2.98): {"separation", "contact"},
    ("hyperbolic", 0.8, 1.524, 3.081): {"stick", "slip"},
    ("exponential", 0.8, 2.357, 0.881): {"separation", "contact", "reversal", "stick", "slip"},
}  # fmt: skip


def on_two_springs(p, alpha1, alpha2):
    """The mass of A1 with linear springs and dashpots."""
    one = np.array([np.cos(alpha1), np.sin(alpha1)])
    other = np.array([-np.cos(alpha2), np.sin(alpha2)])

    def pair(first, second):
        return first * np.outer(one, one) + second * np.outer(other, other)

    contact = Contact("c", {1: 1.0}, {0: 1.0}, p.k3, p.k3 * p.preload)
    return Structure(
        p.mass * np.eye(2), pair(p.k1, p.k2), pair(p.damping1, p.damping2),
        contacts=[contact], mu=p.mu, belt_speed=p.belt_speed, load=0,
        friction_law=p.friction_law, mu_static=p.mu_static, friction_speed=p.friction_speed,
    )  # fmt: skip


@pytest.mark.parametrize(("case", "kinds"), ANGLES.items())
def test_one_contact_on_two_springs_is_a1_with_linear_springs(case, kinds):
    law, mu_static, *angles = case
    p = Parameters(
        mass=2.0, k1=3.0, k2=1.5, k3=0.8, mu=0.5, preload=1.0, damping2=0.01,
        belt_speed=-0.4 if mu_static else 0.6,
        friction_law=law, mu_static=mu_static, friction_speed=0.3,
    )  # fmt: skip
    times = np.linspace(0.0, 60.0, 601)
    run = on_two_springs(p, *angles).system().simulate(60.0, times=times)
    truth = simulate(p, *angles, t_end=60.0, model="A1-linear-springs", times=times)
    happened = [str(name).removeprefix("c ") for name in labels(run.event_kind).values]
    assert happened == [str(name) for name in labels(truth.event_kind).values]
    assert set(happened) == kinds
    assert run.event_time.values == pytest.approx(truth.event_time.values, abs=2e-12)
    for name, same in zip(
        ("q1", "q2", "v1", "v2"), ("x", "y", "vx", "vy"), strict=True
    ):
        assert run[name].values == pytest.approx(truth[same].values, abs=1e-12)


def test_a_system_records_its_equations_in_bounds():
    system = elastic_pad().reduce(n_modes=12, frequency_max=60e3).system()
    assert len(json.dumps(system.text)) < 60_000
    assert {"dq1/dt", "dv12/dt", "p4_speed", "part1"} <= set(system.text)
