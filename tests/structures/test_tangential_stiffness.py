"""Contacts with a spring in series with friction (Jenkins' element)."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import Contact, Structure, squeal_ladder, squealing_modes
from squealpipe.structures import Face, elastic_pad
from squealpipe.structures.assess.propensity import known_inputs
from squealpipe.structures.meshes.face_entries import faces_in
from squealpipe.structures.reduction import dependent_of
from squealpipe.structures.units import scales_of
from squealpipe.study.report.structure import structure as report_of


def block(spring, *, mu_static=None, belt_speed=0.3):
    """A mass of 1 kg on a spring of 4 N/m, pressed on the belt by 2 N; what presses is apart."""
    contact = Contact("p", {1: 1.0}, {0: 1.0}, 50.0, 2.0, tangential_stiffness=spring)
    return Structure(
        np.eye(2),
        np.diag([4.0, 100.0]),
        contacts=[contact],
        mu=0.5,
        mu_static=mu_static,
        belt_speed=belt_speed,
    )


def events(run):
    names = run.event_kind.attrs["flag_meanings"].split()
    values = run.event_kind.attrs["flag_values"].tolist()
    kinds = [names[values.index(each)] for each in run.event_kind.values.tolist()]
    return kinds, run.event_time.values


def states(system, run):
    return np.stack([run[name].values for name in system.states], axis=1)


def test_a_block_sticks_and_slips_as_in_closed_form():
    spring, limit, belt = 30.0, 0.7 * 2.0, 0.3
    system = block(spring, mu_static=0.7).system()
    # q̈ = −4 q + spring (belt t − q) from rest until the spring holds μ_s N
    omega, share = np.sqrt(34.0), spring * belt / 34.0

    def at(t):
        return share * (t - np.sin(omega * t) / omega)

    slips = brentq(lambda t: spring * (belt * t - at(t)) - limit, 0.0, 0.25, xtol=1e-15)
    # then it swings about μN/4 until it is as fast as the belt
    speed, apart = share * (1.0 - np.cos(omega * slips)), at(slips) - 0.25
    amplitude, phase = np.hypot(apart, speed / 2), np.arctan2(-speed / 2, apart)

    def faster(t):
        return -2.0 * amplitude * np.sin(2.0 * t + phase) - belt

    sign = np.diff(faster(np.linspace(0.0, 4.0, 401)) > 0)
    # from slower than the belt to faster
    reached = int(np.flatnonzero(sign)[0])
    sticks = slips + brentq(faster, 0.01 * reached, 0.01 * (reached + 1), xtol=1e-15)
    run = system.simulate(sticks + 0.01)
    kinds, times = events(run)
    assert kinds[0] == "p_slip"
    assert "p_stick" in kinds
    assert times[0] == pytest.approx(slips, rel=1e-12)
    assert times[1] == pytest.approx(sticks, rel=1e-12)


def test_a_stiff_spring_sticks_as_a_rigid_contact():
    def end(spring):
        system = block(spring).system()
        start = {"v1": 0.5, "regime": {"p": "slip_faster"}}
        run = system.simulate(6.0, start=start, times=[6.0])
        return states(system, run)[0, :4]

    rigid = end(None)
    apart = [np.abs(end(spring) - rigid).max() for spring in (1e4, 4e4, 1.6e5)]
    # in proportion to 1/k but for how the vibration of the spring, of size 1/√k, is met
    assert apart[2] < 1e-3
    assert apart[2] < 0.6 * apart[1] < 0.4 * apart[0]


def test_belt_and_friction_balance_the_energy():
    """E + ½ k s² changes by T V of the belt less what sliders and dashpots waste."""
    rng = np.random.default_rng(3)
    contacts = [
        Contact(
            f"c{i}",
            rng.standard_normal(3),
            rng.standard_normal(3),
            20.0,
            60.0,
            speed,
            tangential_stiffness=spring,
        )
        for i, (spring, speed) in enumerate([(40.0, 1.0), (15.0, -0.6)])
    ]
    structure = Structure(
        np.eye(3),
        np.diag([10.0, 30.0, 60.0]),
        0.1 * np.eye(3),
        contacts=contacts,
        mu=0.1,
        belt_speed=1.5,
    )
    system, end = structure.system(), 4.0
    start = {"q1": 0.3, "v2": 1.0, "v3": -1.0}
    knots = [0.0, *system.simulate(end, start=start).event_time.values, end]
    assert len(knots) > 8
    points, weights = np.polynomial.legendre.leggauss(12)
    pieces = [np.linspace(a, b, 9) for a, b in pairwise(knots)]
    spans = np.concatenate([np.stack([p[:-1], p[1:]], 1) for p in pieces])
    half = 0.5 * (spans[:, 1] - spans[:, 0])
    nodes = (spans.mean(1)[:, None] + half[:, None] * points).ravel()
    run = system.simulate(end, start=start, times=np.append(nodes, end), tol=1e-14)
    path = states(system, run)
    q, v, stretch = path[:, :3], path[:, 3:6], path[:, 6:]
    springs = structure.tangential_stiffnesses
    friction, belt = springs * stretch, structure.speeds * structure.belt_speed
    pressing = structure.pressing(q @ structure.normals)
    slips = np.abs(friction) >= (1.0 - 1e-9) * 0.1 * pressing
    rate = -structure.stiffnesses * (v @ structure.normals)
    lengthens = np.sign(friction) * 0.1 * rate / springs
    wasted = slips * friction * (belt - v @ structure.tangentials - lengthens)
    power = (friction * belt - wasted).sum(1) - 0.1 * (v**2).sum(1)
    work = np.sum((power[:-1].reshape(-1, 12) @ weights) * half)
    stiffness = structure.stiffness_at_rest.toarray()

    def energy(q, v, stretch):
        return 0.5 * (v @ v + q @ stiffness @ q + springs @ stretch**2)

    begun = energy(np.array([0.3, 0, 0]), np.array([0, 1.0, -1.0]), np.zeros(2))
    assert slips.any()
    assert not slips.all()
    assert energy(q[-1], v[-1], stretch[-1]) - begun == pytest.approx(work, rel=1e-10)


def on_one_tangent(spring):
    contacts = [
        Contact(name, {1: 1.0}, {0: 1.0}, 20.0, 2.0, tangential_stiffness=spring)
        for name in ("a", "b")
    ]
    return Structure(np.eye(2), np.diag([4.0, 50.0]), contacts=contacts, belt_speed=0.2)


def test_contacts_on_one_tangent_stick_each_by_its_spring():
    assert dependent_of(on_one_tangent(None)) == ["a", "b"]
    structure = on_one_tangent(30.0)
    assert dependent_of(structure) == []
    system = structure.system()
    run = system.simulate(0.05, start={"a_stretch": 0.01, "b_stretch": -0.005})
    assert np.array_equal(run.regime.values[-1], run.regime.values[0])
    lengthened = states(system, run)[-1, 4:] - [0.01, -0.005]
    assert lengthened[0] == pytest.approx(lengthened[1], rel=1e-12)
    assert lengthened[0] > 0.005


def test_sprung_contacts_may_be_more_than_modes():
    pad = elastic_pad(contacts=8, elements=(8, 2))
    with pytest.raises(ValueError, match="tangential_stiffness"):
        pad.reduce(n_modes=5)
    contacts = [replace(each, tangential_stiffness=1e8) for each in pad.contacts]
    reduced = pad.with_(contacts=contacts).reduce(n_modes=5)
    assert reduced.size == 5


def test_a_softer_lining_is_softer_in_both_directions():
    pad = elastic_pad(contacts=2)
    contacts = [replace(pad.contacts[0], tangential_stiffness=3e7), pad.contacts[1]]
    pad = pad.with_(contacts=contacts)
    for name, factors in (("contact_stiffness", [0.5, 0.5]), ("p1", [0.5, 1.0])):
        key = name if name == "contact_stiffness" else f"contact_stiffness_{name}"
        softer = known_inputs(pad)[key](pad, 0.5)
        assert (softer.stiffnesses / pad.stiffnesses).tolist() == factors
        assert softer.tangential_stiffnesses.tolist() == [1.5e7, 0.0]
        assert softer.contacts[1].tangential_stiffness is None


def test_complex_modes_stay():
    pad = elastic_pad(contacts=2, elements=(4, 2)).reduce(n_modes=6)
    contacts = [replace(each, tangential_stiffness=1e7) for each in pad.contacts]
    sprung = pad.with_(contacts=contacts).complex_modes()
    assert sprung.growth_rate.equals(pad.complex_modes().growth_rate)


@pytest.mark.release
def test_a_static_start_of_steady_sliding_slips_on():
    pad = elastic_pad(contacts=2, mu=0.2, modal_damping=0.05).reduce(n_modes=6)
    contacts = [replace(each, tangential_stiffness=1e8) for each in pad.contacts]
    sprung = pad.with_(contacts=contacts)
    answer = squealing_modes(sprung, samples=2)
    rows = report_of(sprung.complex_modes(mu=[0.1, 0.2]), answer)["contacts"]
    assert rows[0]["stiffness"] == "400 kN/mm, 100 kN/mm along the belt"
    assert answer.share.values.sum() == 1.0
    assert answer.stretch.shape == (answer.sizes["attractor"], 2)


def test_derivatives_go_through_switches_of_sprung_contacts():
    system = block(30.0, mu_static=0.7).system()

    def end(**changed):
        start = {"q1": changed.pop("q1", 0.1)}
        return states(system, system.simulate(5.0, start=start, times=[5.0], **changed))

    told = system.simulate(
        5.0, start={"q1": 0.1}, times=[5.0], sensitivity=["mu", "belt_speed", "q10"]
    )
    assert told.sizes["event"] > 2
    for name, key, value in (
        ("mu", "mu", 0.5),
        ("belt_speed", "belt_speed", 0.3),
        ("q1", "q10", 0.1),
    ):
        step = 1e-6
        apart = end(**{name: value + step}) - end(**{name: value - step})
        found = [float(told[f"{state}_by_{key}"][0]) for state in system.states]
        assert found == pytest.approx(
            (apart[0] / (2 * step)).tolist(), rel=1e-5, abs=1e-6
        )


def test_the_stretch_of_a_slipping_start_follows_from_friction():
    system = block(30.0).system()
    start = {"q1": 0.25, "p_stretch": 1.0 / 30.0}
    told = system.simulate(
        0.1, start=start, times=[0.1], sensitivity=["mu", "p_stretch0"]
    )
    assert told.sizes["event"] == 0
    assert float(told.p_stretch_by_mu[0]) == pytest.approx(2.0 / 30.0, rel=1e-12)
    assert float(told.p_stretch_by_p_stretch0[0]) == 0.0


@pytest.mark.release
def test_multipliers_of_a_hammering_pad_are_those_of_its_runs():
    pad = elastic_pad(contacts=4, modal_damping=0.01).reduce(n_modes=6)
    contacts = [replace(each, tangential_stiffness=2e8) for each in pad.contacts]
    system = pad.with_(contacts=contacts).system()
    settled = system.simulate(0.02, start={"v3": 1.0}, times=[0.02])
    guess = dict(zip(system.states, states(system, settled)[0], strict=True))
    cycle = system.limit_cycle(guess=guess, t_settle=0.02)
    assert cycle.multiplier_real.size == 16
    period = float(cycle.period)
    base = np.array([float(cycle[f"{name}_start"]) for name in system.states])
    names = cycle.start_regime.attrs["flag_meanings"].split()
    values = cycle.start_regime.attrs["flag_values"].tolist()
    regime = {
        each.name: names[values.index(int(code))].removeprefix(f"{each.name}_")
        for each, code in zip(contacts, cycle.start_regime.values, strict=True)
    }
    sizes = np.array([system.typical_sizes[name] for name in system.states])
    steps = 1e-6 * np.vstack([np.diag(sizes), -np.diag(sizes)])

    def end(start):
        named = dict(zip(system.states, start, strict=True))
        named["regime"] = regime
        return states(system, system.simulate(period, start=named, times=[period]))[0]

    assert end(base) == pytest.approx(base, rel=1e-9, abs=1e-12)
    ahead, back = np.split(np.array([end(base + step) for step in steps]), 2)
    slopes = (ahead - back).T / (2e-6 * sizes)
    apart = np.sort(np.abs(np.linalg.eigvals(slopes)))
    found = np.abs(cycle.multiplier_real.values + 1j * cycle.multiplier_imag.values)
    assert np.sort(found) == pytest.approx(apart, rel=1e-5, abs=1e-6)


def test_a_face_shares_its_springs_and_a_table_keeps_them(tmp_path):
    corners = np.array([[0, 0, 0], [0.03, 0, 0], [0.03, 0.01, 0], [0, 0.01, 0]])
    face = Face(
        "foot",
        stiffness="2 kN/mm",
        pressure="1 MPa",
        direction=[1, 0, 0],
        tangential_stiffness="1.2 kN/mm",
    )
    entry = {"surface": "foot", "stiffness": "2 kN/mm", "pressure": 1.0}
    entry |= {"direction": [1, 0, 0], "tangential_stiffness": 1200.0}
    read = faces_in({"foot": entry}, tmp_path, scales_of("mm-t-s"))["foot"]
    assert read.tangential_stiffness == pytest.approx(face.tangential_stiffness)
    arguments = {
        "mesh": (corners, {"foot": [[0, 3, 2, 1]]}),
        "contacts": {"foot": face},
    }
    made = Structure.from_mesh(0.01 * np.eye(12), 1e6 * np.eye(12), **arguments)
    assert made.tangential_stiffnesses.tolist() == pytest.approx([3e5] * 4)
    merged = made.with_points(1)
    assert merged.tangential_stiffnesses.tolist() == pytest.approx([1.2e6])
    made.write_contacts(tmp_path / "contacts.csv")
    np.savez(tmp_path / "m.npz", 0.01 * np.eye(12))
    for name in ("mass", "stiffness"):
        lines = (f"{i} {i} {value}" for i, value in enumerate([1.0] * 12, 1))
        text = "%%MatrixMarket matrix coordinate real symmetric\n12 12 12\n"
        (tmp_path / f"{name}.mtx").write_text(text + "\n".join(lines) + "\n")
    text = "".join(f"{name}: {name}.mtx\n" for name in ("mass", "stiffness"))
    names = (tmp_path / "contacts.csv").read_text()
    for row, (node, axis) in enumerate(
        ((node, axis) for node in range(1, 5) for axis in (1, 2, 3)), 1
    ):
        names = names.replace(f"{node}.{axis}:", f"{row}:")
    (tmp_path / "contacts.csv").write_text(names)
    (tmp_path / "pad.yaml").write_text(text + "contacts: contacts.csv\nunits: m-kg-s\n")
    again = Structure.read(tmp_path / "pad.yaml")
    assert again.tangential_stiffnesses.tolist() == made.tangential_stiffnesses.tolist()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"tangential_stiffness": 0.0}, "greater than 0"),
        ({"tangential_stiffness": "3 kg"}, "tangential_stiffness"),
        ({"tangential_stiffness": 1.0, "friction_law": "exponential"}, "coulomb"),
    ],
)
def test_what_no_spring_can_have_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        Structure(
            np.eye(2),
            np.eye(2),
            contacts=[Contact("p", {1: 1.0}, {0: 1.0}, 50.0, 2.0, **changes)],
        )


def test_the_ladder_says_that_smoothed_friction_has_no_springs():
    pad = elastic_pad(contacts=2)
    contacts = [replace(each, tangential_stiffness=1e7) for each in pad.contacts]
    with pytest.raises(ValueError, match="tangential_stiffness"):
        squeal_ladder(pad.with_(contacts=contacts), frequency_max=2e4)
