"""Contacts with a friction of their own, against matrices put together here."""

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg as la
from scipy.integrate import solve_ivp

from squealpipe import Contact, Structure, load, squealing_modes
from squealpipe.cli import run
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.files import read
from squealpipe.structures.schema.structures import Onset
from tests.oracles.written import written

TABLE = "linear 0:0.5 4:0.3"


def random_case(seed, size=7, number=3):
    """M, C, K, normals, tangentials (size, number), springs and preloads of a random structure."""
    generator = np.random.default_rng([64, seed])
    mass, stiffness = generator.standard_normal((2, size, size)) / np.sqrt(size)
    normal, tangential = generator.standard_normal((2, size, number))
    damping = 0.01 * np.eye(size)
    springs, preload = generator.uniform([[0.5], [20]], [[8], [40]], (2, number))
    return (
        mass @ mass.T + 0.5 * np.eye(size),
        damping,
        10 * stiffness @ stiffness.T + np.eye(size),
        normal,
        tangential,
        springs,
        preload,
    )


def structure_of(
    case, speeds=(1.0, -1.0, 2.0), own=((), (), ()), names="abc", **further
):
    mass, damping, stiffness, *parts = case
    columns = zip(names, *(part.T for part in parts), speeds, own, strict=True)
    contacts = [Contact(*each[:-1], **dict(each[-1])) for each in columns]
    return Structure(mass, stiffness, damping, contacts=contacts, **further)


def growth(case, drag, slope=0.0):
    """Largest growth rate with all contacts closed, by a first-order form; forces of contacts."""
    mass, damping, stiffness, normal, tangential, springs, preload = case
    acting = normal + tangential * drag
    matrix = stiffness + acting * springs @ normal.T
    q = la.solve(matrix, (acting - normal) @ preload)
    force = preload - springs * (normal.T @ q)
    assert (force > 0).all()
    dashpots = damping + tangential * (force * slope) @ tangential.T
    size = len(mass)
    first = np.block([[np.zeros((size, size)), np.eye(size)], [-matrix, -dashpots]])
    values = la.eigvals(first, la.block_diag(np.eye(size), mass))
    return values.real.max(), force


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("belt_speed", [1.5, -1.5])
def test_each_contact_has_its_own_law(seed, belt_speed):
    """Own mu, a table, and an exponential law of the structure side by side."""
    case = random_case(seed)
    own = ({"mu": 0.15}, {"friction_law": TABLE, "mu": 0.4}, {})
    structure = structure_of(
        case,
        own=own,
        mu=0.2,
        belt_speed=belt_speed,
        friction_law="exponential",
        mu_static=0.3,
        friction_speed=2.0,
    )
    modes = structure.complex_modes(critical=False)
    # of the first contact the law is the structure's without a static limit: Coulomb's
    falling = 0.1 * np.exp(-3.0 / 2.0)
    mu = np.array([0.15, 0.4 * (0.5 - 0.2 * 1.5 / 4), 0.2 + falling])
    slope = np.array([0.0, -0.4 * 0.2 / 4, -falling / 2.0])
    drag = mu * np.sign([belt_speed, -belt_speed, 2 * belt_speed])
    fastest, force = growth(case, drag, slope)
    assert np.allclose(modes.normal_force, force, rtol=1e-10)
    assert abs(modes.growth_rate.max() - fastest) < 1e-9
    limits = [friction.static_mu for friction in structure.frictions]
    assert np.allclose(limits, [0.15, 0.2, 0.3])


def test_speeds_of_the_structures_table_are_in_metres_per_second():
    """``friction_speed``, which is that of formulas, had stretched the table of a structure."""
    case = random_case(1)
    structure = structure_of(case, friction_law=TABLE, mu=0.4, friction_speed=5.0)
    drag = 0.4 * (0.5 - 0.05 * 2.0 * np.array([1.0, 1.0, 2.0]))
    slope = np.array([-0.02, -0.02, -0.01])  # the last one is at a knot, flat beyond
    fastest, force = growth(case, drag * SIGNS, slope)
    modes = structure.complex_modes(critical=False)
    assert np.allclose(modes.normal_force, force, rtol=1e-10)
    assert abs(modes.growth_rate.max() - fastest) < 1e-9


def test_friction_of_a_face_is_changed_in_its_law_and_up_to_its_limit_of_stick():
    """It had lost the fall of the structure's law, and a limit of its own ended ``assess``."""
    case = random_case(1)
    falls = {"friction_law": "exponential", "mu_static": 0.3, "friction_speed": 2.0}
    own = ({}, {}, {"mu": 0.2, "mu_static": 0.35, "friction_law": "coulomb"})
    names = ("lining_1", "lining_2", "back")
    structure = structure_of(case, own=own, names=names, mu=0.2, **falls)
    cures, _ = cures_of(Design.of(structure), {})
    for name, limit, factors in (
        ("mu_lining", 0.3, [1, 1, 0]),
        ("mu_back", 0.35, [0, 0, 1]),
    ):
        assert cures[name].grid.max() <= limit
        for value in (0.2, 0.15, limit):
            mu = np.where(factors, value, 0.2)
            excess = np.array([0.3, 0.3, 0.2]) - np.where([1, 1, 0], mu, 0.2)
            fall = excess * np.exp(-np.array([1.0, 1.0, 2.0]))
            fastest, _ = growth(case, (mu + fall) * SIGNS, -fall / 2.0)
            assert abs(cures[name].apply(value).margin - fastest) < 1e-9, name


def critical_by_hand(case, drag_at, high):
    """Smallest number at which a mode grows, by bisection from a grid."""
    grid = np.linspace(0, high, 401)
    grows = [growth(case, drag_at(each))[0] > 0 for each in grid]
    place = int(np.argmax(grows))
    if not place:
        return np.nan
    low, top = grid[place - 1], grid[place]
    for _ in range(50):
        middle = 0.5 * (low + top)
        low, top = (
            (low, middle) if growth(case, drag_at(middle))[0] > 0 else (middle, top)
        )
    return top


SIGNS = np.array([1.0, -1.0, 1.0])


@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.release), 4])
def test_the_critical_friction_is_that_of_what_is_varied(seed):
    case = random_case(seed)
    own = ({}, {"mu": 0.1}, {"mu": 0.1})
    structure = structure_of(
        case, own=own, names=("back", "lining_1", "lining_2"), mu=0.1
    )
    of_own = np.array([0.1, 0.1, 0.1])
    for name, mask in (("back", [1, 0, 0]), ("lining", [0, 1, 1])):
        expected = critical_by_hand(
            case, lambda mu, mask=mask: SIGNS * np.where(mask, mu, of_own), 0.8
        )
        asked = 0.8 if name == "back" else {name: 0.8}
        modes = structure.complex_modes(mu=asked)
        located = modes.critical_mu.where(modes.onset == Onset.located).min()
        assert modes.mu == 0.8
        assert np.isclose(located, expected, rtol=1e-8, equal_nan=True), name


def test_all_are_scaled_where_each_has_its_own():
    case = random_case(4)
    mu = np.array([0.7, 0.6, 0.8])
    structure = structure_of(case, own=[{"mu": each} for each in mu])
    modes = structure.complex_modes()
    expected = critical_by_hand(case, lambda scale: SIGNS * scale * mu, 1.0)
    assert np.isfinite(expected)
    assert np.isclose(modes.critical_scale.min(), expected, rtol=1e-8)
    assert np.isnan(modes.critical_mu).all()
    assert "mu" not in modes.coords
    assert np.allclose(modes.normal_force, growth(case, SIGNS * mu)[1])


def test_one_friction_of_all_contacts_is_told_as_such(tmp_path, monkeypatch, capsys):
    """A single face at one friction was unstable "somewhere, from 0.9 times every mu on"."""
    monkeypatch.chdir(tmp_path)
    mass, damping, stiffness, normal, tangential, springs, preload = random_case(4)
    for name, matrix in (("M", mass), ("C", damping), ("K", stiffness)):
        np.save(f"{name}.npy", matrix)
    rows = ["name,normal,tangential,stiffness,preload,speed,mu"]
    for name, n, t, k, p, speed in zip(
        "abc", normal.T, tangential.T, springs, preload, (1.0, -1.0, 2.0), strict=True
    ):
        ways = [
            " ".join(f"{at}:{each!r}" for at, each in enumerate(way.tolist(), 1))
            for way in (n, t)
        ]
        rows.append(f"{name},{ways[0]},{ways[1]},{k},{p},{speed},0.7")
    Path("contacts.csv").write_text("\n".join(rows))
    Path("pad.yaml").write_text(
        "mass: M.npy\nstiffness: K.npy\ndamping: C.npy\ncontacts: contacts.csv\n"
    )
    assert run(["modes", "pad.yaml", "-o", "modes.nc"]) == 0
    told = capsys.readouterr().out
    modes = load("modes.nc")
    scale = float(modes.critical_scale.min())
    assert np.isfinite(scale)
    assert f"from mu = {0.7 * scale:.6g} on" in told
    assert "are unstable\n" in told


def test_what_nothing_has_cannot_be_varied():
    structure = structure_of(
        random_case(0), own=[{"mu": 0.3}, {"mu": 0.3}, {"mu": 0.4}]
    )
    with pytest.raises(
        ValueError, match=r"every contact has a mu of its own.*\{'a': …\}"
    ):
        structure.complex_modes(mu=[0.1, 0.2])
    with pytest.raises(ValueError, match="no contact or face 'lining'"):
        structure.complex_modes(mu={"lining": 0.2})
    with pytest.raises(ValueError, match="one contact or face at a time"):
        structure.complex_modes(mu={"a": 0.2, "b": 0.1})
    with pytest.raises(ValueError, match="every contact has one of its own"):
        squealing_modes(structure, onset=True)


def test_a_friction_that_all_contacts_share_can_be_the_structures():
    case = random_case(2)
    structure = structure_of(case, own=[{"mu": 0.3}] * 3, mu=0.9)
    common = structure.with_common_mu()
    assert common.mu == 0.3
    assert np.allclose(
        common.complex_modes(mu=[0.3]).normal_force, growth(case, SIGNS * 0.3)[1]
    )
    different = structure_of(case, own=[{"mu": 0.3}, {"mu": 0.3}, {"mu": 0.4}])
    assert different.with_common_mu() is different


REFUSED = {
    "negative": ({"mu": -0.1}, "contact a: mu = -0.1"),
    "static below": ({"mu": 0.3, "mu_static": 0.2}, "contact a: mu_static = 0.2"),
    "unknown law": ({"friction_law": "coulom"}, "contact a: friction_law = 'coulom'"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_friction_that_none_has_is_refused_by_its_contact(what):
    own, words = REFUSED[what]
    with pytest.raises(ValueError, match=words):
        structure_of(random_case(0), own=(own, {}, {}))


def test_runs_have_different_tables_side_by_side():
    """A table of two pieces, one of three and Coulomb's law, against SciPy."""
    case = random_case(4, size=4)
    other = "linear 0:0.6 2.2:0.4 2.5:0.5"
    own = ({"friction_law": TABLE, "mu": 0.5}, {"friction_law": other}, {"mu": 0.2})
    speeds, belt_speed = np.array([1.0, -1.0, 2.0]), 2.0
    structure = structure_of(case, speeds, own, belt_speed=belt_speed)
    mass, damping, stiffness, normal, tangential, springs, preload = case

    def rates(_, z):
        press = preload - springs * (normal.T @ z[:4])
        slip = speeds * belt_speed - tangential.T @ z[4:]
        assert (press > 0).all()
        size = np.abs(slip)
        mu = [
            0.5 * np.interp(size[0], [0, 4], [0.5, 0.3]),
            np.interp(size[1], [0, 2.2, 2.5], [0.6, 0.4, 0.5]),
            0.2,
        ]
        force = normal @ (press - preload) + tangential @ (mu * np.sign(slip) * press)
        rest = force - stiffness @ z[:4] - damping @ z[4:]
        return np.concatenate([z[4:], la.solve(mass, rest)])

    start = np.zeros(8)
    truth = solve_ivp(
        rates, (0.0, 0.2), start, "DOP853", rtol=1e-11, atol=1e-12, max_step=2e-3
    )
    system = structure.system()
    run = system.simulate(
        0.2, start=dict(zip(system.states, start, strict=True)), times=[0.2]
    )
    kinds = run.event_kind.attrs["flag_meanings"].split()
    assert "b_knot" in [kinds[number] for number in run.event_kind.values]
    assert "c_slip_slower" in system.regimes
    assert "b_slip_faster_2" in system.regimes
    found = np.array([float(run[name][-1]) for name in system.states])
    assert found == pytest.approx(truth.y[:, -1], abs=1e-7)


def test_a_law_in_python_is_refused_by_runs():
    law = "def coefficient(speed, p):\n    return p.mu + 0.1 * speed\n"
    structure = structure_of(random_case(0), own=({"friction_law": law}, {}, {}))
    with pytest.raises(ValueError, match=r"contact a: friction_law = a law in Python"):
        structure.system()


def test_a_law_in_python_runs_by_its_values():
    """The remedy of the refusal, against the law itself with DOP853."""
    law = "def coefficient(speed, p):\n    return 0.3 + 0.2 / (1.0 + speed * speed)\n"
    *matrices, preload = random_case(3, number=1)
    case = (*matrices, 0.1 * preload)
    structure = structure_of(
        case, speeds=(1.0,), own=({},), names="a", friction_law=law, belt_speed=4.0
    )
    speeds = np.linspace(0.0, 10.0, 201)
    values = structure.friction.coefficient(speeds)
    table = {"speed": speeds, "coefficient": values, "between": "cubic"}
    run = (
        structure.with_(friction_law=table, mu=1.0).system().simulate(2.0, times=[2.0])
    )
    names = [f"{kind}{place}" for kind in "qv" for place in range(1, 8)]
    found = [float(run[name][-1]) for name in names]
    assert found == pytest.approx(run_by_the_law(3, 1, 0.1), abs=3e-5)


@written
def run_by_the_law(seed, number, share):
    """Last state of a run by a law of friction, under a share of a random case's preload."""
    case = random_case(seed, number=number)
    mass, damping, stiffness, normal, along, springs, preload = case
    preload = share * preload

    def rates(_, z):
        q, v = np.split(z, 2)
        slide = 4.0 - along[:, 0] @ v
        pressed = preload[0] - springs[0] * normal[:, 0] @ q
        force = -preload[0] * normal[:, 0] - stiffness @ q - damping @ v
        force += pressed * normal[:, 0]
        force += (0.3 + 0.2 / (1.0 + slide**2)) * pressed * along[:, 0]
        assert pressed > 0 < slide
        return [*v, *np.linalg.solve(mass, force)]

    truth = solve_ivp(rates, (0.0, 2.0), np.zeros(14), "DOP853", rtol=1e-11, atol=1e-12)
    return truth.y[:, -1]


def test_a_reduced_structure_and_its_runs_have_them():
    """All modes kept, small motions grow as the complex modes do."""
    case = random_case(4, size=5, number=2)
    own = ({"mu": 0.9}, {})
    whole = structure_of(
        case, speeds=(1.0, -1.0), own=own, names="ab", mu=0.8, belt_speed=50.0
    )
    reduced = whole.reduce(n_modes=5)
    assert np.allclose(
        np.sort(reduced.complex_modes(critical=False).growth_rate),
        np.sort(whole.complex_modes(critical=False).growth_rate),
    )
    system = whole.system()
    assert system.parameters == {
        "mu": 0.8,
        "a_mu": 0.9,
        "belt_speed": 50.0,
        "preload": 1.0,
    }
    mass, damping, stiffness, normal, tangential, springs, preload = case
    mu, side = np.array([0.9, 0.8]), np.array([1.0, -1.0])
    acting = normal + tangential * (mu * side)
    matrix = stiffness + acting * springs @ normal.T
    first = np.block(
        [
            [np.zeros((5, 5)), np.eye(5)],
            [-la.solve(mass, matrix), -la.solve(mass, damping)],
        ]
    )
    rest = la.solve(matrix, (acting - normal) @ preload)
    push = 1e-3 * np.arange(1.0, 6.0)
    run = system.simulate(
        3.0, start={f"q{i}": each for i, each in enumerate(rest + push, 1)}
    )
    end = la.expm(first * float(run.time[-1])) @ np.concatenate([push, np.zeros(5)])
    found = np.array([run[f"q{i}"].values[-1] for i in range(1, 6)])
    assert run.sizes["event"] == 0
    assert np.allclose(found, rest + end[:5], atol=1e-9)


def test_a_table_of_contacts_has_a_column_of_friction(tmp_path):
    np.save(tmp_path / "K.npy", np.diag([2.0, 3.0]))
    np.save(tmp_path / "M.npy", np.eye(2))
    (tmp_path / "contacts.csv").write_text(
        "name,normal,tangential,stiffness,preload,mu,mu_static\n"
        "a,2:1,1:1,1,2,,\nb,2:1,1:2,1,2,0.3,35 %\n"
    )
    (tmp_path / "s.yaml").write_text(
        "mass: M.npy\nstiffness: K.npy\ncontacts: contacts.csv\nmu: 0.2\n"
    )
    structure = read(tmp_path / "s.yaml", Structure)
    assert structure.mu_of_contacts.tolist() == [0.2, 0.3]
    assert [friction.static_mu for friction in structure.frictions] == [0.2, 0.35]
