"""What stops a structure, against eigenvalues of matrices that are written down here."""

import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import brentq

from squealpipe import Contact, Structure, assess, load, save
from squealpipe.cli.arguments import modifications_of
from squealpipe.codes import Verdict
from squealpipe.structures import disc_brake, elastic_pad
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.assess.modifications import read_modification
from squealpipe.structures.meshes.structure_mesh import StructureMesh
from squealpipe.structures.quiet_intervals import linear_intervals
from squealpipe.vibration.schema import Mechanism

MASS, STIFFNESS, PRELOAD, MU = 0.5, 6e6, 3000.0, 0.5
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])
WEIGHT, STRUT, DASHPOT = 0.3, 2e7, 600.0


def two_degrees(**changes):
    """Flutter: along and across the belt are coupled by the rod and by friction."""
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, PRELOAD)
    arguments = {"damping": 8.0 * np.eye(2), "contacts": [contact], "mu": MU, "load": 0}
    return Structure(MASS * np.eye(2), ROD, **arguments | changes)


def growth(mass=0.0, spring=0.0, dashpot=0.0, mu=MU, damping=8.0):
    """Largest real part by numpy: friction μ k along the belt where the pad moves across it."""
    m = MASS * np.eye(2) + np.diag([0.0, mass])
    k = ROD + np.diag([spring, 0.0]) + STIFFNESS * np.array([[0.0, mu], [0.0, 1.0]])
    c = damping * np.eye(2) + dashpot * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inverse = np.linalg.inv(m)
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ c]])
    return np.linalg.eigvals(state).real.max()


MODIFICATIONS = {
    "weight": {"added_mass": {1: WEIGHT}},
    "strut": {"spring": {0: STRUT}},
    "damper": {"dashpot": {(0, 1): DASHPOT}},
}


OTHERS = {"mu": "mu", "weight": "mass", "strut": "spring", "damper": "dashpot"}
"""Cure → the argument of growth that it changes."""


def crossings(argument, grid):
    """Values at which small motions begin to grow, or cease."""
    margins = [growth(**{argument: value}) for value in grid]
    return [
        brentq(lambda value: growth(**{argument: value}), low, high)
        for low, high, one, other in zip(
            grid, grid[1:], margins, margins[1:], strict=False
        )
        if one * other < 0.0
    ]


@pytest.mark.parametrize(
    "cure",
    [
        pytest.param(n, marks=[pytest.mark.release] * (row > 1))
        for row, n in enumerate(OTHERS)
    ],
)
def test_linear_boundaries_of_cures_are_those_of_own_eigenvalues(cure):
    assert growth() > 0.0
    design = Design.of(two_degrees())
    assert design.plant.rate == pytest.approx(growth(), rel=1e-6)
    assert design.mechanism is Mechanism.flutter
    cures, _ = cures_of(design, MODIFICATIONS)
    intervals = linear_intervals(
        lambda value: cures[cure].apply(value).structure,
        cures[cure].grid.tolist(),
        cures[cure].value,
    )
    grid = cures[cure].grid
    found = sorted(edge for each in intervals for edge in each.edges())
    truth = crossings(OTHERS[cure], np.linspace(grid[0], grid[-1], 400))
    assert truth or cure == "damper"  # which does not stop it
    assert found == pytest.approx(truth, rel=1e-6)


@pytest.mark.release
def test_what_stops_it_is_quiet_there_and_not_beside(tmp_path):
    answer = assess(two_degrees(), modifications=MODIFICATIONS, samples=4, workers=1)
    assert Verdict(int(answer.verdict)) is not Verdict.quiet
    mu = answer.quiet_from_any_start.sel(cure="mu").item()
    assert mu <= crossings("mu", np.linspace(0.0, MU, 50))[0] * (1.0 + 1e-9)
    quiet = assess(two_degrees(mu=0.99 * mu), samples=4, workers=1)
    assert int(quiet.verdict) == Verdict.quiet
    assert not bool(quiet.quiet_unless_struck)
    assert quiet.velocity_rms_along.item() == 0.0
    again = load(save(answer, tmp_path / "answer.nc"))
    assert again.quiet_low.equals(answer.quiet_low)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"added_mass": {7: 0.1}}, "the structure has 2 degrees of freedom"),
        ({"added_mass": {1: -0.1}}, "greater than 0"),
        ({"added_mass": {(0, 1): 0.1}}, "a mass is at one degree of freedom"),
        ({"sprng": {1: 0.1}}, "did you mean 'spring'"),
        ({"spring": {"5005.3": 1e6}}, "no mesh"),
        ({"spring": {(1, 1): 1e6}}, "two different"),
        (0.1, "added_mass, spring, dashpot, patch, chamfer is needed"),
        ({"patch": {"nodes": "BACK", "mass": 0.1}}, "no mesh"),
        ({"patch": {"nodes": "BACK"}}, "mass or damping_ratio"),
        ({"patch": {"nodes": "BACK", "mas": 0.1}}, "did you mean 'mass'"),
        (
            {"chamfer": {"face": "pad", "share": 0.2}},
            "single contact, which must remain",
        ),
        ({"chamfer": {"face": "lining", "share": 0.2}}, "'lining'"),
        ({"chamfer": {"face": "pad"}}, "face and share"),
    ],
)
def test_a_modification_that_cannot_be_is_refused_with_its_name(content, message):
    with pytest.raises(ValueError, match="modifications: weight") as error:
        read_modification("weight", content, two_degrees(), 1000.0)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("content", "place"),
    [({"added_mass": {7: 1.0}}, "8"), ({"spring": {(0, 6): 1.0}}, "(1, 7)")],
)
def test_a_message_for_files_counts_from_one(content, place):
    message = re.escape(
        f"weight: {next(iter(content))}[{place}]: the structure has 2 degrees"
    )
    with pytest.raises(ValueError, match=message):
        read_modification("weight", content, two_degrees(), 1000.0, first=1)


def test_a_structure_has_no_angles_and_a_pad_no_modifications():
    with pytest.raises(ValueError, match=r"alpha1 = 1\.0: a structure has none"):
        assess(two_degrees(), 1.0)
    with pytest.raises(ValueError, match="name of a cure"):
        assess(two_degrees(), modifications={"mu": {"added_mass": {1: 0.1}}})


def test_parts_that_change_with_speed_are_not_added_twice():
    centrifugal = sp.csr_array(np.diag([1e5, 0.0]))
    turning = two_degrees(speed_terms={"stiffness": [(centrifugal, 2)]})
    change = read_modification("strut", {"spring": {0: 1e6}}, turning, 1000.0)
    added = (change.of(turning, 1e6).stiffness - turning.stiffness).toarray()
    assert added == pytest.approx(np.diag([1e6, 0.0]))


PAD = elastic_pad(modal_damping=0.01)
UPPER = (np.flatnonzero(np.isclose(PAD.mesh.nodes[:, 1], 0.015)) + 1).tolist()


def test_a_patch_weighs_what_it_weighs_and_does_not_damp_rigid_motions():
    content = {"patch": {"nodes": UPPER, "mass": "200 g", "damping_ratio": 0.05}}
    change = read_modification("shim", content, PAD, 9700.0)
    assert (change.most, change.unit) == (0.2, "kg")
    patched = change.of(PAD, 0.1)
    mass = (patched.mass - PAD.mass).toarray()
    damping = (patched.given_damping - PAD.given_damping).toarray()
    node, direction = PAD.mesh.degree_of_freedom.T
    x, y = PAD.mesh.nodes[node, :2].T
    along, across = (direction == 1) * 1.0, (direction == 2) * 1.0
    for rigid in (along, across):
        assert rigid @ mass @ rigid == pytest.approx(0.1)
    for rigid in (along, across, across * x - along * y):
        assert abs(rigid @ damping @ rigid) < 1e-9 * np.abs(damping).max()
    bends = across * x**2
    assert bends @ damping @ bends > 0.0
    assert np.linalg.eigvalsh(damping).min() > -1e-9 * np.abs(damping).max()


def test_a_patch_over_a_free_bar_has_its_damping_ratio_at_its_frequency():
    """Stiffness-proportional damping 2 ζ/ω K has the ratio ζ ω_j/ω at each mode ω_j."""
    springs = 1e6 * (2.0 * np.eye(4) - np.eye(4, k=1) - np.eye(4, k=-1))
    springs[0, 0] = springs[3, 3] = 1e6
    mesh = StructureMesh(
        np.column_stack([np.arange(4.0), np.zeros((4, 2))]),
        [[0, 1], [1, 2], [2, 3]],
        np.column_stack([np.arange(4), np.ones(4, int)]),
        sets={"BAR": [1, 2, 3, 4]},
    )
    bar = Structure(np.eye(4), springs, mesh=mesh)
    content = {"patch": {"nodes": "bar", "damping_ratio": 0.03}}
    omega = 1e3 * 2.0 * np.sin(np.pi * np.arange(4) / 8.0)
    change = read_modification("shim", content, bar, omega[2] / (2.0 * np.pi))
    assert change.unit == "1"
    values, shapes = np.linalg.eigh(springs)
    assert np.sqrt(np.abs(values[1:])) == pytest.approx(omega[1:])
    damped = np.diag(shapes.T @ change.of(bar, 0.03).damping.toarray() @ shapes)
    assert damped[1:] / (2.0 * omega[1:]) == pytest.approx(0.03 * omega[1:] / omega[2])
    assert abs(damped[0]) < 1e-9 * damped[-1]


@pytest.mark.parametrize(("speed", "lost"), [(2.0, "p1"), (-2.0, "p4")])
def test_a_chamfer_takes_points_off_where_the_belt_arrives(speed, lost):
    pad = PAD.with_(belt_speed=speed)
    names = [each.name for each in pad.contacts]
    face = pad.with_(
        contacts=[replace(each, name=f"pad_{each.name[1:]}") for each in pad.contacts]
    )
    change = read_modification(
        "edge", {"chamfer": {"face": "pad", "share": 0.5}}, face, 1.0
    )
    half, one = (change.of(face, amount).contacts for amount in (0.125, 0.25))
    assert sum(each.preload for each in half) == pytest.approx(800.0)
    by_name = {each.name: each for each in half}
    end = by_name[f"pad_{lost[1:]}"]
    assert end.stiffness == pytest.approx(1e8)
    assert end.preload == pytest.approx(100.0 / 700.0 * 800.0)
    assert [each.name for each in one] == [
        f"pad_{name[1:]}" for name in names if name != lost
    ]
    assert [each.preload for each in one] == pytest.approx([800.0 / 3.0] * 3)


def test_a_chamfer_of_a_lining_on_a_disc_begins_where_the_disc_comes_from():
    brake = disc_brake()
    share = 0.25
    for speed in (20.0, -20.0):
        turned = brake.with_(belt_speed=speed)
        content = {"chamfer": {"face": "lining", "share": share}}
        kept = read_modification("edge", content, turned, 1.0).of(turned, share)
        names = {each.name for each in kept.contacts}
        places = {each.name: each.origin.position for each in turned.contacts}
        angle = {name: np.arctan2(at[1], at[0]) for name, at in places.items()}
        middle = np.arctan2(*np.mean([*places.values()], axis=0)[1::-1])
        ahead = {
            name: np.sign(speed) * np.angle(np.exp(1j * (at - middle)))
            for name, at in angle.items()
        }
        lost = set(places) - names
        assert lost
        assert max(ahead[each] for each in lost) < 0.0
        assert max(ahead[each] for each in lost) <= min(
            ahead[each] for each in names
        ) + np.radians(8.0)
        force = sum(each.preload for each in turned.contacts)
        assert sum(each.preload for each in kept.contacts) == pytest.approx(force)


def test_modifications_of_the_command_line_are_those_of_python():
    texts = ["shim=patch BACK 0.2 0.05", "edge=chamfer lining 0.2"]
    texts += ["damped=patch 5,6 0 0.03", "strut=spring 1,4 1e6"]
    assert modifications_of(texts) == {
        "shim": {"patch": {"nodes": "BACK", "mass": 0.2, "damping_ratio": 0.05}},
        "edge": {"chamfer": {"face": "lining", "share": 0.2}},
        "damped": {"patch": {"nodes": [5, 6], "damping_ratio": 0.03}},
        "strut": {"spring": {(0, 3): 1e6}},
    }
    with pytest.raises(ValueError, match="--modify shim=patch BACK"):
        modifications_of(["shim=patch BACK"])
