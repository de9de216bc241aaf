"""Contacts of structures whose force is a table of the compression."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.io

from squealpipe import Contact, Structure, labels, squealing_modes
from squealpipe.codes import Regime
from squealpipe.store.rerun.key import files_named_in
from squealpipe.structures.contact import PointOrigin
from squealpipe.structures.contact_table import read_contacts
from squealpipe.structures.fewer_points import _joined
from squealpipe.structures.meshes.face_entries import faces_in
from squealpipe.structures.sliding import NoSlidingError, steady_sliding
from squealpipe.structures.squeal.settled_run import squealing_run
from squealpipe.structures.units import scales_of
from squealpipe.study.report.structure import structure as structure_rows
from tests.oracles.many_contacts import compare
from tests.structures.test_many_contacts import random_structure


def with_tables(structure, seed):
    """The structure with tables of two to four pieces in place of most of its springs."""
    rng = np.random.default_rng([seed, 1])
    contacts = []
    for contact in structure.contacts:
        knots = np.cumsum(rng.uniform(0.1, 0.5, int(rng.integers(2, 5))))
        forces = np.cumsum(
            np.diff(knots, prepend=0.0) * rng.uniform(0.3, 3.0, len(knots))
        )
        pairs = " ".join(
            f"{a!r}:{b!r}" for a, b in zip(knots.tolist(), forces.tolist(), strict=True)
        )
        law = None if rng.random() < 0.2 else f"linear 0:0 {pairs}"
        stiffness = contact.stiffness if law is None else None
        contacts.append(replace(contact, law=law, stiffness=stiffness))
    return structure.with_(contacts=contacts)


@pytest.mark.parametrize(
    "seed",
    [1, 2, *(pytest.param(seed, marks=pytest.mark.release) for seed in range(3, 12))],
)
def test_tables_of_force_agree_with_an_integrator_apart(seed):
    structure, q, v = random_structure(seed)
    assert compare(with_tables(structure, seed), q, v) == "ok"


BENT = "linear 0:0 0.4:0.2 0.9:1.1 2:4"


def one_point(law, stiffness=None, **options):
    """Two modes that flutter by friction, with a contact that opens."""
    matrix = np.array([[2.0, -1.0], [-1.0, 2.0 / 3.0]])
    numbers = {"mu": 1.0, "belt_speed": -5.0, "preload": 1.0} | options
    preload = numbers.pop("preload")
    contact = Contact("c", {1: -1.0}, {0: 1.0}, stiffness, preload, law=law)
    return Structure(np.eye(2), matrix, 0.04 * np.eye(2), contacts=[contact], **numbers)


def test_a_table_of_one_slope_is_a_spring():
    table, spring = (
        one_point(*each).system() for each in (("linear 0:0 1:1.5 3:4.5",), (None, 1.5))
    )
    start = {"q1": 0.3, "v2": -0.8}
    runs = [each.simulate(30.0, start=start, times=[30.0]) for each in (table, spring)]
    assert len(runs[0].event_time) == len(runs[1].event_time) > 5
    for name in table.states:
        assert float(runs[0][name][0]) == pytest.approx(float(runs[1][name][0]), 1e-12)


@pytest.mark.parametrize(
    ("preload", "slope"), [(50.0, 1e7), (90.0, 2e7), (91.0, 2e7), (400.0, 2e7)]
)
def test_at_a_point_of_the_table_a_preload_has_the_slope_of_larger_compressions(
    preload, slope
):
    contact = Contact(
        "c", {0: -1}, {1: 1}, None, preload, law="linear 0:0 9e-6:90 1e-5:110"
    )
    assert contact.stiffness_at_preload == pytest.approx(slope, rel=1e-12)


def test_small_motions_feel_the_slope_at_steady_sliding():
    structure = one_point(BENT, mu=0.4)
    modes = structure.complex_modes()
    force = float(modes.normal_force[0])
    assert 0.2 < force < 1.1
    # the spring of that piece, whose preload is the force of the piece where nᵀq = 0
    compression = 0.4 + (1.0 - 0.2) / 1.8
    springs = one_point(None, 1.8, preload=0.2 + 1.8 * (compression - 0.4), mu=0.4)
    same = springs.complex_modes()
    assert force == pytest.approx(float(same.normal_force[0]), rel=1e-13)
    np.testing.assert_allclose(modes.growth_rate, same.growth_rate, atol=1e-13)
    np.testing.assert_allclose(modes.frequency, same.frequency, rtol=1e-13)


def test_steady_sliding_balances_tables_of_many_contacts():
    structure = with_tables(random_structure(5)[0], 5)
    state = steady_sliding(structure, structure.mu, structure.belt_speed)
    forces = [
        np.interp(
            contact.compression
            - contact.direction("normal", structure.size) @ state.displacement,
            *_points(contact.law),
        )
        if contact.law
        else max(contact.preload - contact.stiffness * (n @ state.displacement), 0.0)
        for contact, n in zip(structure.contacts, structure.normals.T, strict=True)
    ]
    pushes = structure.normals + structure.tangentials * state.drag
    left = structure.load + pushes @ forces - structure.stiffness @ state.displacement
    assert np.abs(left).max() < 1e-13
    np.testing.assert_allclose(state.force, forces, atol=1e-13)


def _points(law):
    """Knots and values of a table, with a point far beyond on the last slope."""
    (x, y) = np.array([each.split(":") for each in law.split()[1:]], float).T
    slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return [*x, x[-1] + 1e3], [*y, y[-1] + 1e3 * slope]


def test_steady_sliding_that_is_not_unique_is_refused():
    # friction presses the contact on by 1.84 m/N: in the soft piece less than it is pressed, in
    # the stiff one more
    matrix = np.array([[1.0, -0.9], [-0.9, 1.0]])
    contact = Contact(
        "c", {0: 1.0}, {1: -1.0}, preload=1.0, law="linear 0:0 1:0.1 2:20"
    )
    structure = Structure(
        np.eye(2), matrix, contacts=[contact], mu=1.5, belt_speed=1.0, load=[0.12, 0.0]
    )
    with pytest.raises(NoSlidingError, match="is not unique") as refused:
        steady_sliding(structure, 1.5, 1.0)
    assert "N, or" in str(refused.value)
    assert steady_sliding(structure, 0.1, 1.0).force[0] > 0


def test_of_many_contacts_steady_sliding_is_found_and_a_second_one_refused():
    # eight times the contact of before: more combinations of pieces than are all tried
    number = 8
    block = np.array([[1.0, -0.9], [-0.9, 1.0]])
    contacts = [
        Contact(
            f"c{i}",
            {2 * i: 1.0},
            {2 * i + 1: -1.0},
            preload=1.0 + 0.1 * i,
            law="linear 0:0 1:0.1 2:20",
        )
        for i in range(number)
    ]
    structure = Structure(
        np.eye(2 * number),
        np.kron(np.eye(number), block),
        contacts=contacts,
        mu=1.5,
        belt_speed=1.0,
        load=np.tile([0.12, 0.0], number),
    )
    with pytest.raises(NoSlidingError, match="is not unique"):
        steady_sliding(structure, 1.5, 1.0)
    state = steady_sliding(structure, 0.1, 1.0)
    forces = [
        contact.force(-displacement)
        for contact, displacement in zip(contacts, state.displacement[::2], strict=True)
    ]
    np.testing.assert_allclose(state.force, forces, rtol=1e-12)
    drag = np.stack([forces, -0.1 * np.array(forces)], axis=1).ravel()
    balance = structure.stiffness @ state.displacement - structure.load - drag
    np.testing.assert_allclose(balance, 0.0, atol=1e-12)


def test_the_factor_of_preload_moves_along_the_table():
    start = {"q1": 0.3, "v2": -0.8}
    scaled = one_point(BENT).system().simulate(9.0, start=start, preload=1.7)
    other = one_point(BENT, preload=1.7).system().simulate(9.0, start=start)
    np.testing.assert_allclose(scaled.event_time, other.event_time, rtol=1e-12)
    np.testing.assert_allclose(scaled.c_normal_force, other.c_normal_force, atol=1e-11)


def test_a_cycle_over_a_table_closes_and_has_its_multipliers():
    structure = one_point(BENT)
    system = structure.system()
    run = system.simulate(500.0, start={"q1": 1e-2}, times=[500.0])
    cycle = system.limit_cycle(
        start={name: float(run[name][-1]) for name in system.states}
    )
    assert int(cycle.outcome) == 0
    period = float(cycle.period)
    state = [float(cycle[f"{name}_start"]) for name in system.states]

    def after(change):
        start = dict(zip(system.states, np.array(state) + change, strict=True))
        end = system.simulate(period, start=start, times=[period])
        return np.array([float(end[name][-1]) for name in system.states])

    np.testing.assert_allclose(after(0.0), state, atol=1e-9)
    step = 1e-6 * np.eye(len(state))
    columns = [(after(each) - after(-each)) / 2e-6 for each in step]
    found = np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))
    given = np.hypot(cycle.multiplier_real, cycle.multiplier_imag).values
    np.testing.assert_allclose(found, np.sort(given), atol=1e-6)


@pytest.mark.release
def test_a_curve_of_folds_over_a_table_meets_the_folds_of_branches():
    system = one_point(BENT).system()

    def branch(preload):
        values = {"mu": 0.62, "preload": preload}
        run = system.simulate(700.0, start={"q1": 0.3}, times=[700.0], **values)
        start = {name: float(run[name][-1]) for name in system.states}
        cycle = system.limit_cycle(start=start, **values)
        return system.cycle_branch("mu", 0.5, start=cycle)

    first, other = branch(1.0), branch(1.1)
    to = {"preload": (0.9, 1.1)}
    curve = system.cycle_curve("fold", ("mu", "preload"), start=first, to=to)
    end = curve.preload.values.argmax()
    assert float(curve.preload[end]) == pytest.approx(1.1, rel=1e-12)
    (fold,) = other.mu.values[labels(other.label) == "fold"]
    assert float(curve.mu[end]) == pytest.approx(fold, rel=1e-9)


def test_points_that_are_merged_keep_their_force():
    origin = PointOrigin((1,), (), 1.0, 0.0, (0.0, 0.0, 0.0))
    members = [
        Contact("a", {0: 1.0}, {1: 1.0}, None, 1.0, law=BENT, origin=origin),
        Contact("b", {0: 1.0}, {1: 1.0}, None, 0.1, law=BENT, origin=origin),
        Contact("d", {0: 1.0}, {1: 1.0}, 3.0, 0.5, origin=origin),
    ]
    whole = _joined("e", members, 2)
    for lift in np.linspace(-2.0, 2.0, 41):
        apart = sum(max(float(each.force(-lift)), 0.0) for each in members)
        assert max(float(whole.force(-lift)), 0.0) == pytest.approx(apart, abs=1e-12)


def test_tables_are_read_from_files_and_written_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lining.csv").write_text(
        "compression [mm];force [kN]\n0;0\n0,01;0,09\n0,02;0,24\n"
    )
    law = "linear 0.0:0.0 1e-05:90.0 2e-05:240.0"
    lists = {"compression": ["0 mm", "10 um", 2e-5], "force": [0, 90, "0.24 kN"]}
    contacts = [
        Contact(name, {0: 1.0}, {1: 1.0}, preload=100.0, law=given)
        for name, given in (("a", "lining.csv"), ("b", lists), ("d", law))
    ]
    assert [contact.law for contact in contacts] == [law] * 3
    scipy.io.mmwrite("M.mtx", np.eye(2))
    structure = Structure(np.eye(2), np.eye(2), contacts=contacts)
    structure.write_contacts("contacts.csv")
    (tmp_path / "pad.yaml").write_text(
        "units: mm-t-s\nmass: M.mtx\nstiffness: M.mtx\ncontacts: contacts.csv\n"
    )
    assert [each.law for each in Structure.read("pad.yaml").contacts] == [law] * 3
    rows = ["name,normal,tangential,preload,law"]
    rows += ["a,1:1,2:1,100,lining.csv", "b,1:1,2:1,100,0:0 0.01:90 0.02:240"]
    (tmp_path / "by_hand.csv").write_text("\n".join(rows))
    # an edit of the table of force reruns what depends on it, and archives hold it
    (tmp_path / "by_hand.yaml").write_text("contacts: by_hand.csv\n")
    assert f"{tmp_path}/lining.csv" in files_named_in([f"{tmp_path}/by_hand.yaml"])
    read = read_contacts(tmp_path / "by_hand.csv", None, 2, scales_of("mm-t-s"))
    for each in read:
        assert each.compression == pytest.approx(1e-5 + 1e-5 * 10 / 150)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"law": BENT, "stiffness": 2.0}, "stiffness = 2.0: the law has one already"),
        ({"law": "dashpot"}, "law = 'dashpot': contacts of structures are linear"),
        ({"law": "linear 0:0 1:1 2:1"}, "must rise with its compression: 1 N at 2 m"),
        ({"law": "linear 0:1 1:2"}, "begins with compression 0 and force 0"),
        ({"law": "cubic 0:0 1:1 2:3"}, "write between: linear"),
        ({}, "stiffness is missing; give it, or a law"),
        ({"law": {"compression": [0, 1], "force": [0]}}, "2 and 1 values"),
    ],
)
def test_other_laws_are_refused_by_name(options, message):
    with pytest.raises(ValueError, match="contact c: ") as refused:
        Contact("c", {0: 1.0}, {1: 1.0}, preload=1.0, **options)
    assert message in str(refused.value)


def test_squeal_over_a_table_is_told_with_its_forces_and_regimes():
    structure = one_point(BENT, mu=0.9)
    answer = squealing_modes(structure, samples=4)
    assert float(answer.separated_fraction.max()) > 0.1
    shown = squealing_run(structure, answer)
    codes = {int(code) for code in np.unique(shown.regime)}
    assert Regime.separated in codes
    assert codes <= {*Regime}
    lift = shown.displacement.values @ shown.mode_shape.values.T @ [0.0, -1.0]
    knots, forces = _points(BENT)
    expected = np.interp(0.4 + 0.8 / 1.8 - lift, knots, forces)
    np.testing.assert_allclose(shown.normal_force[:, 0], expected, atol=1e-9)
    contact = structure_rows(structure.complex_modes(), answer)["contacts"][0]
    assert contact["stiffness"] == "1.8 N/m at the preload"


def test_a_law_of_a_face_is_shared_by_area(tmp_path):
    """Uneven facets: the forces of all points together are the table's at every compression."""
    corners = np.array(
        [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0], [3, 0, 0], [3, 1, 0]]
    )
    facets = {"foot": [[0, 3, 2, 1], [1, 2, 5, 4]]}
    (tmp_path / "lining.csv").write_text(
        "compression [um];force [kN]\n0;0\n10;1\n20;4\n"
    )
    law = faces_in(
        {
            "foot": {
                "surface": "foot",
                "force": 1.5e3,
                "law": "lining.csv",
                "direction": [1, 0, 0],
            }
        },
        tmp_path,
        scales_of("mm-t-s"),
    )["foot"]
    listed = {"compression": [0, 0.01, "20 um"], "force": [0, 1e3, 4e3]}
    entry = {"surface": "foot", "force": 1.5e3, "law": listed, "direction": [1, 0, 0]}
    again = faces_in({"foot": entry}, tmp_path, scales_of("mm-t-s"))["foot"]
    assert law.law == again.law == "linear 0.0:0.0 1e-05:1000.0 2e-05:4000.0"
    structure = Structure.from_mesh(
        np.eye(18), np.eye(18), mesh=(0.01 * corners, facets), contacts={"foot": law}
    )
    area = np.array([each.origin.area for each in structure.contacts])
    assert area.max() > 2 * area.min()
    for lift in np.linspace(-2e-5, 1e-5, 7):
        forces = [float(each.force(-lift)) for each in structure.contacts]
        np.testing.assert_allclose(forces, area / area.sum() * sum(forces), rtol=1e-12)
        whole = np.interp(1e-5 + 1e-5 / 6 - lift, [0, 1e-5, 1e-3], [0, 1e3, 298e3])
        assert sum(forces) == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("preload", [0.1, 0.2, 0.8, 7.0])
def test_the_energy_of_the_preload_is_the_integral_of_the_force(preload):
    """In the first piece of a table, at its end, in the second and beyond the last point."""
    contact = Contact("p", {0: 1.0}, {1: 1.0}, None, preload, law=BENT)
    compression = np.linspace(0.0, contact.compression, 200_001)
    force = contact.force(compression - contact.compression)
    assert force[-1] == pytest.approx(preload)
    energy = np.trapezoid(force, compression)
    assert contact.energy_at_preload == pytest.approx(energy, rel=1e-8)
