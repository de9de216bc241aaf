"""Friction and contact from tables: against scipy's DOP853, energy, and the laws they sample."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe import Parameters
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run
from squealpipe.laws.contact import law as contact_law
from squealpipe.laws.friction_laws import coefficient
from squealpipe.laws.springs import elastic_force, geometry
from tests.oracles.energy import elastic_energy

ANGLES = (1.0, 2.2)
STICKING = (0.1, 1.5)
"""Angles at which the mass sticks again and again."""
PAD = {
    "mass": 0.5,
    "k1": 1e7,
    "k2": 1.3e7,
    "preload": 2e-5,
    "length1": 0.02,
    "length2": 0.03,
}
FRICTION = "linear 0:0.55 0.3:0.5 0.5:0.35 0.9:0.4 2:0.2"
SOFTENING = "linear 0:0 1e-5:20 3e-5:140 5e-5:300"

OWN = """\
from squealpipe.functions import exp

def coefficient(speed, p):
    return p.mu * (1.0 + 0.5 * exp(-speed / 0.2))
"""


def knots_of(text):
    return np.array([tuple(map(float, pair.split(":"))) for pair in text.split()[1:]]).T


def run(params, t_end, times, angles=ANGLES, **start):
    found = brake_of(params).simulate(
        t_end, times=times, start=start, **parameters_of_run(params, *angles)
    )
    assert (
        found.outcome.attrs["flag_meanings"].split()[int(found.outcome)] == "converged"
    )
    return found


def reference(params, angles, times, start, friction, contact):
    """DOP853 on the forces themselves, in units of l_pre and √(m/k1)."""
    unit, time, g = params.preload, params.time_unit, geometry(*angles)

    def rates(_, z):
        x, y, vx, vy = np.array(z) * [unit, unit, unit / time, unit / time]
        fx, fy = elastic_force(x, y, params, g)
        n = contact(params.preload - y, -vy)
        fx += (
            n * np.sign(params.belt_speed - vx) * friction(abs(params.belt_speed - vx))
        )
        scale = time * time / (params.mass * unit)
        return [z[2], z[3], fx * scale, (fy + n) * scale]

    z = np.array(start) / [unit, unit, unit / time, unit / time]
    found = solve_ivp(
        rates,
        (0.0, times[-1] / time),
        z,
        "DOP853",
        times / time,
        rtol=1e-12,
        atol=1e-12,
        max_step=0.02,
    )
    return found.y * np.array([[unit], [unit], [unit / time], [unit / time]])


def compared(params, start, friction, contact, tol, angles=ANGLES):
    """Our run and the largest difference from the reference, over each state's size."""
    t_end = 12.0 * params.time_unit
    times = np.linspace(0.0, t_end, 25)
    ours = run(params, t_end, times, angles, **start)
    z0 = [start.get(name, 0.0) for name in ("x", "y", "vx", "vy")]
    other = reference(params, angles, times, z0, friction, contact)
    for name, values in zip(("x", "y", "vx", "vy"), other, strict=True):
        assert np.abs(ours[name].values - values).max() < tol * np.abs(values).max(), (
            name
        )
    return ours


def kinds(found):
    names = found.event_kind.attrs["flag_meanings"].split()
    return [names[kind] for kind in found.event_kind.values]


def test_a_table_of_friction_agrees_with_scipy_across_its_knots():
    params = Parameters(**PAD, k3=7e6, belt_speed=0.6, friction_law=FRICTION)
    knots, values = knots_of(FRICTION)
    laws = lambda w: np.interp(w, knots, values), lambda d, _: 7e6 * max(d, 0.0)
    found = compared(params, {"vx": 0.3}, *laws, 1e-8)
    assert kinds(found).count("knot") >= 4


def balance(params, t_end, **start):
    """Largest residual of the energy balance from event to event, over the energy at the start."""
    g = geometry(*ANGLES)
    events = run(params, t_end, np.array([0.0]), **start).event_time.values
    marks = np.unique(np.concatenate([np.linspace(0.0, t_end, 40), events]))
    node, weight = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(marks)
    times = (marks[:-1, None] + half[:, None] * (1.0 + node)).ravel()
    inside = run(params, t_end, times, **start)
    ends = run(params, t_end, marks, **start)
    lag = params.belt_speed - inside.vx.values
    closing = -inside.vy.values
    squeezed = params.preload - inside.y.values
    names = inside.regime.attrs["flag_meanings"].split()
    touching = np.array(
        [names[r] not in {"separated", "released"} for r in inside.regime.values]
    )
    force = np.where(
        touching, contact_law(params).force(squeezed, closing, params), 0.0
    )
    sticks = np.array([names[r].startswith("stick") for r in inside.regime.values])
    drag = coefficient(np.abs(lag), params) * force * np.sign(lag)
    pull = elastic_force(inside.x.values, inside.y.values, params, g)[0]
    power = np.where(sticks, -params.belt_speed * pull, drag * inside.vx.values)
    work = force * inside.vy.values + power
    gained = (work.reshape(-1, node.size) @ weight) * half
    x, y, vx, vy = (ends[name].values for name in ("x", "y", "vx", "vy"))
    energy = 0.5 * params.mass * (vx**2 + vy**2) + elastic_energy(x, y, params, g)
    scale = float(np.abs(energy).max())
    return float(np.abs(np.cumsum(gained) - (energy[1:] - energy[0])).max()) / scale


@pytest.mark.parametrize(
    "laws",
    [
        {"friction_law": FRICTION, "k3": 7e6},
        {"friction_law": FRICTION.replace("linear", "cubic"), "k3": 7e6},
        {"friction_law": FRICTION, "contact_law": SOFTENING},
        {"friction_law": OWN, "mu": 0.3, "k3": 7e6},
        {"mu": 0.4, "k3": 7e6, "contact_law": "dashpot", "damping3": 300.0},
    ],
)
def test_energy_changes_by_the_work_of_friction_and_contact(laws):
    params = Parameters(**PAD, belt_speed=0.4, **laws)
    assert balance(params, 30.0 * params.time_unit, vx=0.1) < 1e-11


def test_a_table_of_contact_agrees_with_scipy_across_its_knots():
    params = Parameters(**PAD, belt_speed=50.0, mu=0.4, contact_law=SOFTENING)
    knots, values = knots_of(SOFTENING)

    def force(d, _):
        beyond = (
            max(d - knots[-1], 0.0)
            * (values[-1] - values[-2])
            / (knots[-1] - knots[-2])
        )
        return np.interp(d, knots, values) + beyond

    found = compared(params, {"vy": -0.3}, lambda _: 0.4, force, 1e-8)
    assert kinds(found).count("knot") >= 4
    assert "separation" in kinds(found)


def test_a_contact_with_a_dashpot_lets_go_where_its_force_is_zero():
    params = Parameters(
        **PAD, belt_speed=50.0, mu=0.4, k3=7e6, contact_law="dashpot", damping3=600.0
    )

    def force(d, closing):
        return max(7e6 * d + 600.0 * closing, 0.0) if d > 0 else 0.0

    found = compared(params, {"vy": -0.3}, lambda _: 0.4, force, 1e-6, STICKING)
    assert {"separation", "contact"} <= set(kinds(found))
    regimes = found.regime.attrs["flag_meanings"].split()
    released = found.event_regime.values == regimes.index("released")
    assert released.any()
    # while it is apart within the free length the mass moves out faster than the spring follows
    y = found.y.where(found.regime == regimes.index("released"), drop=True)
    assert (y < params.preload).all()
