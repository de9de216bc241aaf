"""Structures in motion against model A1, an integrator apart, and conserved quantities."""

import functools
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Contact, Parameters, Structure, labels, simulate
from squealpipe.structures import elastic_pad
from tests.oracles.many_contacts import OPEN, ManyContacts, instants

ANGLES = {
    ("exponential", None, 0.453, 2.98): {"separation", "contact"},
    ("hyperbolic", 0.8, 1.524, 3.081): {"stick", "slip"},
    ("exponential", 0.8, 2.357, 0.881): {
        "separation",
        "contact",
        "reversal",
        "stick",
        "slip",
    },
}


def on_two_springs(p, alpha1, alpha2):
    """The mass of A1 with linear springs and dashpots."""
    one = np.array([np.cos(alpha1), np.sin(alpha1)])
    other = np.array([-np.cos(alpha2), np.sin(alpha2)])

    def pair(first, second):
        return first * np.outer(one, one) + second * np.outer(other, other)

    contact = Contact("c", {1: 1.0}, {0: 1.0}, p.k3, p.k3 * p.preload)
    return Structure(
        p.mass * np.eye(2),
        pair(p.k1, p.k2),
        pair(p.damping1, p.damping2),
        contacts=[contact],
        mu=p.mu,
        belt_speed=p.belt_speed,
        load=0,
        friction_law=p.friction_law,
        mu_static=p.mu_static,
        friction_speed=p.friction_speed,
    )


@pytest.mark.parametrize(("case", "kinds"), ANGLES.items())
def test_one_contact_on_two_springs_is_a1_with_linear_springs(case, kinds):
    law, mu_static, *angles = case
    p = Parameters(
        mass=2.0,
        k1=3.0,
        k2=1.5,
        k3=0.8,
        mu=0.5,
        preload=1.0,
        damping2=0.01,
        belt_speed=-0.4 if mu_static else 0.6,
        friction_law=law,
        mu_static=mu_static,
        friction_speed=0.3,
    )
    times = np.linspace(0.0, 60.0, 601)
    run = on_two_springs(p, *angles).system().simulate(60.0, times=times)
    truth = simulate(p, *angles, t_end=60.0, model="A1-linear-springs", times=times)
    happened = [str(name).removeprefix("c_") for name in labels(run.event_kind).values]
    same = [str(name).replace(" ", "_") for name in labels(truth.event_kind).values]
    assert happened == same
    assert set(happened) == kinds
    assert run.event_time.values == pytest.approx(truth.event_time.values, abs=2e-12)
    for name, same in zip(
        ("q1", "q2", "v1", "v2"), ("x", "y", "vx", "vy"), strict=True
    ):
        assert run[name].values == pytest.approx(truth[same].values, abs=1e-12)


# friction can hold the first; the second is drawn beyond its limit at once
@pytest.mark.parametrize("x", [0.0, 0.9])
def test_a_start_at_the_speed_of_the_belt_is_in_the_regime_of_a1(x):
    p = Parameters(
        mass=2.0, k1=3.0, k2=1.5, k3=0.8, mu=0.5, preload=1.0, belt_speed=0.4
    )
    run = (
        on_two_springs(p, 0.5, 1.2)
        .system()
        .simulate(3.0, start={"q1": x, "v1": p.belt_speed}, times=[0.0, 3.0])
    )
    truth = simulate(
        p,
        0.5,
        1.2,
        t_end=3.0,
        model="A1-linear-springs",
        times=[0.0, 3.0],
        initial_state=(x, 0.0, p.belt_speed, 0.0),
    )
    first = str(labels(run.regime).values[0]).removeprefix("c_")
    assert first == str(labels(truth.regime).values[0]).replace(" ", "_")
    assert (first == "stick") == (x == 0.0)
    assert run.event_time.values == pytest.approx(truth.event_time.values, abs=2e-12)


def names(size):
    return [f"{letter}{i}" for letter in "qv" for i in range(1, size + 1)]


@functools.cache
def twelve_modes():
    """The elastic pad by its twelve lowest modes, with 1 % of damping."""
    return elastic_pad(modal_damping=0.01).reduce(n_modes=12, frequency_max=60e3)


def kicked(seed, size, displacement, velocity):
    """A start of random displacements and velocities of these sizes."""
    generator = np.random.default_rng(seed)
    return np.concatenate(
        [scale * generator.standard_normal(size) for scale in (displacement, velocity)]
    )


def confirmed(structure, state, t_end, step, preload=1.0, **parameters):
    """A run that agrees with matrix exponentials, and the sides of its contacts."""
    size, system = structure.size, structure.system()
    given = {"start": dict(zip(names(size), state, strict=True)), "preload": preload}
    run = system.simulate(t_end, times=[0.0, t_end], **given, **parameters)
    assert labels(run.outcome).item() == "converged"
    pressed = [replace(c, preload=preload * c.preload) for c in structure.contacts]
    apart = structure.with_(
        contacts=pressed, load=preload * structure.load, **parameters
    )
    truth = ManyContacts(apart, state[:size], state[size:])
    expected, found = truth.run(t_end, step), instants(run)
    changes = [tuple(side for side, _ in contacts) for _, contacts in found]
    assert changes == [sides for _, sides in expected]
    times = [[time for time, _ in each] for each in (found, expected)]
    assert times[0] == pytest.approx(times[1], rel=1e-13)
    final = np.array([run[name].values[-1] for name in names(size)])
    for part in (slice(size), slice(size, None)):
        limit = 1e-11 * np.abs(truth.state[part]).max()
        assert final[part] == pytest.approx(truth.state[part], abs=limit)
    return run, np.array(changes)


@pytest.mark.parametrize(
    "parameters",
    [
        {"belt_speed": -0.2, "mu": 0.8, "preload": 0.6},
        pytest.param({}, marks=pytest.mark.release),
        pytest.param({"belt_speed": 0.1, "mu": 0.8}, marks=pytest.mark.release),
        pytest.param({"belt_speed": -0.2, "preload": 0.6}, marks=pytest.mark.release),
    ],
)
def test_the_pad_moves_as_an_integrator_apart_has_it(parameters):
    pad = twelve_modes()
    start = kicked(3, 12, 1.5e-7, 0.08)
    _, sides = confirmed(pad, start, 0.25e-3, 2e-6, **parameters)
    assert {OPEN, np.sign(parameters.get("belt_speed", 1))} <= set(sides.flat)
    assert (sides == 0).any() == bool(parameters)


def coupled_contacts(**friction):
    """Four masses that move each other, three contacts, all near the speed of the belt."""
    generator = np.random.default_rng(8)
    mass, stiffness = generator.standard_normal((2, 4, 4))
    contacts = [
        Contact(
            name,
            generator.standard_normal(4),
            generator.standard_normal(4),
            stiffness=2.0,
            preload=1.0,
            speed=speed,
        )
        for name, speed in (("a", 1.0), ("b", 0.6), ("c", -0.8))
    ]
    return Structure(
        mass @ mass.T + np.eye(4),
        stiffness @ stiffness.T + np.eye(4),
        0.05 * np.eye(4),
        contacts=contacts,
        belt_speed=0.2,
        **friction,
    )


@pytest.mark.parametrize(
    "seed", [0, 1, *(pytest.param(n, marks=pytest.mark.release) for n in (2, 3))]
)
def test_contacts_that_stick_together_share_their_forces_rightly(seed):
    structure = coupled_contacts(mu=0.8)
    _, sides = confirmed(structure, kicked(seed, 4, 0.4, 0.3), 25.0, 0.05)
    assert ((sides[1:] == 0) & (sides[:-1] != 0)).sum() > 3


def test_a_run_tells_force_and_speed_at_each_contact_and_displacements_by_name():
    structure = coupled_contacts(mu=0.8)
    system = structure.system(displacements={"nose": {0: 1.0, 3: -0.5}, "tail": 2})
    start = dict(zip(names(4), kicked(0, 4, 0.4, 0.3), strict=True))
    run = system.simulate(25.0, start=start, times=np.linspace(0.0, 25.0, 400))
    q, v = (np.array([run[f"{letter}{i}"] for i in range(1, 5)]) for letter in "qv")
    regimes = labels(run.regime).values.astype(str)
    assert run.nose.values == pytest.approx(q[0] - 0.5 * q[3], abs=1e-14)
    assert run["tail"].values == pytest.approx(q[2], abs=1e-14)
    for place, contact in enumerate(structure.contacts):
        away = np.char.endswith(regimes[:, place], "separated")
        force = np.where(away, 0.0, 1.0 - 2.0 * structure.normals[:, place] @ q)
        assert run[f"{contact.name}_normal_force"].values == pytest.approx(
            force, abs=1e-13
        )
        speed = 0.2 * contact.speed - structure.tangentials[:, place] @ v
        assert run[f"{contact.name}_speed"].values == pytest.approx(speed, abs=1e-13)
        sticks = np.char.endswith(regimes[:, place], "stick")
        assert np.abs(speed[sticks]).max(initial=0.0) < 1e-13
    with pytest.raises(ValueError, match="degrees of freedom are 0 to 3"):
        structure.system(displacements={"far": 4})


@pytest.mark.parametrize(("law", "mu"), [("coulomb", 0.9), ("linear 0:0.5 1:0.3", 1.7)])
def test_a_run_with_more_friction_than_its_limit_of_stick_is_refused(law, mu):
    pad = elastic_pad(contacts=2, elements=(4, 2))
    own = (
        {"friction_law": law, "mu": 1.0, "mu_static": 0.8}
        if " " in law
        else {"mu_static": 0.8}
    )
    system = pad.with_(**own).reduce(n_modes=4).system()
    with pytest.raises(
        ValueError, match=rf"mu = {mu}: mu_static = 0\.8 is below"
    ) as error:
        system.ensemble(1e-5, mu=[0.1, mu])
    needed = float(re.search(r"give mu_static = (\S+)", str(error.value))[1])
    assert system.simulate(1e-5, mu=mu, mu_static=needed).outcome == 0


def test_what_is_too_large_for_a_system_says_how_to_make_it_small():
    whole = Structure(np.eye(40), np.diag(np.arange(1.0, 41.0)))
    with pytest.raises(ValueError, match=r"take structure\.reduce\(\)"):
        whole.system()
    with pytest.raises(ValueError, match="n_modes=32"):
        whole.reduce(n_modes=33).system()
    assert len(whole.reduce(n_modes=32).system().states) == 64


def test_three_contacts_land_at_one_instant():
    # three light feet, each with a spring of its own along the belt, under one mass
    stiffness = np.diag([1.0, 2.0, 3.0, 4.0])
    contacts = [
        Contact(f"foot{i}", {0: 1.0}, {i: 1.0}, stiffness=5.0, preload=1.0)
        for i in (1, 2, 3)
    ]
    structure = Structure(
        np.diag([1.0, 0.3, 0.2, 0.1]),
        stiffness,
        contacts=contacts,
        mu=0.3,
        belt_speed=0.5,
        load=0,
    )
    start = np.array([0.5, 0.0, 0.1, 0.0, -0.2, 0.0, 0.1, 0.0])
    run, _ = confirmed(structure, start, 6.0, 0.05)
    entered = labels(run.event_regime).values.astype(str)
    landings = run.event_time.values[np.char.endswith(entered, "slip_slower")][:3]
    assert len(landings) == 3
    assert np.ptp(landings) < 1e-14


def test_a_contact_that_slips_lets_the_other_go():
    # both are held by the static limit; when the first goes, what friction loses pulls the second
    mass = np.array([[1.0, 0.0, -0.7], [0.0, 1.0, 0.0], [-0.7, 0.0, 1.0]])
    contacts = [
        Contact("first", {1: 1.0}, {0: 1.0}, stiffness=1.0, preload=1.0),
        Contact("second", {1: 1.0}, {2: 1.0}, stiffness=1.0, preload=1.0),
    ]
    structure = Structure(
        mass,
        np.diag([1.0, 1.0, 1.0]),
        contacts=contacts,
        mu=0.2,
        mu_static=0.6,
        belt_speed=0.1,
    )
    start = {"v1": 0.1, "v3": 0.1, "q3": -0.05}
    sticks = {"regime": {"first": "stick", "second": "stick"}}
    run = structure.system().simulate(20.0, start=start | sticks)
    kinds = [str(kind) for kind in labels(run.event_kind).values]
    assert kinds[:2] == ["first_slip", "second_slip"]
    assert run.event_time.values[0] == run.event_time.values[1]


def test_a_system_records_its_equations_in_bounds():
    system = elastic_pad().reduce(n_modes=12, frequency_max=60e3).system()
    assert len(json.dumps(system.text)) < 60_000
    assert {"dq1/dt", "dv12/dt", "p4_speed", "equations"} <= set(system.text)


def energy_and_work(pad, t_end, belt_speed):
    """Energy before and after a run from a kick, the work of friction and dashpots, and the run.

    Between events motion is smooth: eight points of Gauss' rule in at most 4 µs each, a tenth of
    the shortest period, are exact to round-off.
    """
    system, size = pad.system(), pad.size
    start = dict(zip(names(size), kicked(5, size, 1.5e-7, 0.08), strict=True))
    first = system.simulate(t_end, start=start, belt_speed=belt_speed)
    ends = [np.arange(0.0, t_end, 4e-6), first.event_time.values, [t_end]]
    ends = np.unique(np.concatenate(ends))
    points, weights = np.polynomial.legendre.leggauss(8)
    times = (ends[:-1, None] + np.diff(ends)[:, None] * 0.5 * (points + 1.0)).ravel()
    weights = (0.5 * np.diff(ends)[:, None] * weights).ravel()
    run = system.simulate(
        t_end, start=start, belt_speed=belt_speed, times=[0.0, *times, t_end]
    )
    q, v = (
        np.array([run[f"{letter}{i}"] for i in range(1, size + 1)]) for letter in "qv"
    )
    meanings = np.array(run.regime.attrs["flag_meanings"].split())
    codes = run.regime.values.T  # by component
    stiffness = pad.stiffnesses[:, None]
    closed = ~np.char.endswith(meanings, "separated")[codes]
    normal = np.where(
        closed, pad.preloads[:, None] - stiffness * (pad.normals.T @ q), 0.0
    )
    energy = (
        0.5 * (v**2).sum(axis=0)
        + 0.5 * np.einsum("it,ij,jt->t", q, pad.stiffness.toarray(), q, optimize=True)
        + 0.5 * (normal**2 / stiffness).sum(axis=0)
        - pad.load @ q
    )
    signs = np.where(np.char.endswith(meanings, "slower"), 1.0, 0.0)
    signs -= np.char.endswith(meanings, "faster")
    sticks = np.char.endswith(meanings, "stick")[codes]
    # friction from the motion: what of M q̈ other forces leave, by the directions of friction
    friction = friction_from(pad, q, v, sticks, signs[codes] * pad.mu * normal, normal)
    power = (friction * (pad.tangentials.T @ v)).sum(axis=0)
    power -= (v * (pad.damping.toarray() @ v)).sum(axis=0)
    return energy, weights @ power[1:-1], run, sticks


def friction_from(pad, q, v, sticks, friction, normal):
    """T of each contact: μ N in slip; in stick what keeps it on the belt, instant by instant."""
    rest = (
        pad.load[:, None] - pad.stiffness @ q - pad.damping @ v + pad.normals @ normal
    )
    rest = rest + pad.tangentials @ friction
    friction = friction.copy()
    for row in np.unique(sticks, axis=1).T:
        if row.any():
            instants = np.flatnonzero((sticks == row[:, None]).all(axis=0))
            t = pad.tangentials[:, row]
            held = np.linalg.solve(t.T @ t, -t.T @ rest[:, instants])
            friction[np.ix_(row, instants)] = held
    return friction


@pytest.mark.release
def test_the_work_of_friction_and_dashpots_is_the_change_of_energy():
    energy, work, _, sticks = energy_and_work(twelve_modes(), 2e-3, belt_speed=0.3)
    assert sticks.any()
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-11 * energy.max())


@pytest.mark.release
def test_energy_is_balanced_over_ten_thousand_events():
    energy, work, run, sticks = energy_and_work(twelve_modes(), 38e-3, belt_speed=2.0)
    assert run.sizes["event"] >= 10_000
    assert sticks.any()
    assert energy[-1] - energy[0] == pytest.approx(work, abs=1e-11 * energy.max())


@pytest.mark.release
def test_a_settled_millisecond_of_the_pad_takes_few_steps():
    """Cost that no clock tells; tests/benchmarks/bench_structures.py has times."""
    system, t_end = twelve_modes().system(), 20e-3
    settled = system.simulate(t_end, times=[0.0, t_end])
    start = {name: float(settled[name][-1]) for name in names(12)}
    run = system.simulate(4e-3, start=start)
    steps = run.sizes["time"] / 4  # instants of a run are four a step
    assert run.sizes["event"] > 1400
    assert steps < 1.6 * run.sizes["event"]


def test_a_small_start_grows_at_the_rate_of_the_complex_mode():
    pad = twelve_modes()
    modes = pad.complex_modes()
    growth = float(modes.growth_rate.max())
    # the linear motion about steady sliding, written out: s x = A x
    acting = pad.normals + pad.mu * pad.tangentials
    stiffness = (
        pad.stiffness.toarray() + acting @ np.diag(pad.stiffnesses) @ pad.normals.T
    )
    zero, one = np.zeros((12, 12)), np.eye(12)
    values, right = np.linalg.eig(
        np.block([[zero, one], [-stiffness, -pad.damping.toarray()]])
    )
    chosen = int(values.real.argmax())
    left = np.linalg.inv(right)[chosen]
    rest = np.linalg.solve(stiffness, pad.load + acting @ pad.preloads)
    mode = np.real(right[:, chosen])
    small = 1e-4 * np.abs(rest).max() / np.abs(mode[:12]).max()
    state = np.concatenate([rest, 0 * rest]) + small * mode
    start = dict(zip(names(12), state, strict=True))
    run = pad.system().simulate(1e-3, start=start, times=[0.0, 1e-3])
    assert run.sizes["event"] == 0
    ends = np.array([run[name].values for name in names(12)])
    ends[:12] -= rest[:, None]
    before, after = np.abs(left @ ends)
    assert np.log(after / before) / 1e-3 == pytest.approx(growth, rel=1e-6)


@pytest.mark.release
def test_the_settled_pad_hammers_as_an_integrator_apart_has_it():
    """A cycle with nine events, whatever the start.

    An integrator from the finite elements on, with all roots of each event's polynomial, has open
    0.000, 0.312, 0.395, 0.306, stick 0.0109 and 374.7 events a ms, from rest and from two random
    starts. The second contact overtakes the belt for so short a time before it sticks that a
    search for events by signs at the ends of steps misses some of it: solve_ivp has 303 to 336
    events a ms, and less stick.
    """
    pad, times = twelve_modes(), np.linspace(24e-3, 40e-3, 2**16)
    run = pad.system().simulate(40e-3, times=times)
    regimes = labels(run.regime).values.astype(str)
    is_open, sticks = (
        [float(np.char.endswith(row, name).mean()) for row in regimes.T]
        for name in ("separated", "stick")
    )
    assert is_open == pytest.approx([0.0, 0.312, 0.395, 0.306], abs=1e-3)
    assert sticks == pytest.approx([0.0, 0.0109, 0.0, 0.0], abs=3e-4)
    spectrum = np.abs(np.fft.rfft(run.v1.values - run.v1.values.mean()))
    frequency = np.fft.rfftfreq(2**16, 16e-3 / (2**16 - 1))[spectrum.argmax()]
    assert frequency == pytest.approx(41.62e3, rel=1e-3)
    late = run.event_time.values > 24e-3
    assert late.sum() / 16.0 == pytest.approx(374.7, abs=0.2)
