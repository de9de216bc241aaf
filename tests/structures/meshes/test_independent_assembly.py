"""Contacts of meshes against an assembly that shares no code with the package."""

import numpy as np
import pytest

from squealpipe import Face, Rotation, Structure
from tests.oracles import mesh_contacts as oracle


def both(nodes, faces, mass, stiffness, axis, through=(0, 0, 0), mesh=None):
    """The structure of the package, and the oracle's contacts."""
    face = Face("PAD", against="DISC", stiffness_per_area=4e11, pressure=5e5)
    structure = Structure.from_mesh(
        mass,
        stiffness,
        mesh=(nodes, faces) if mesh is None else mesh,
        contacts={"lining": face},
        rotation=Rotation(axis=axis, through=through, speed=10.0),
        degrees_of_freedom=[(n, d) for n in nodes for d in (1, 2, 3)],
        mu=0.5,
    )
    row_of = {(n, d): 3 * i + d - 1 for i, n in enumerate(nodes) for d in (1, 2, 3)}
    unit = np.array(axis) / np.linalg.norm(axis)
    known = oracle.contacts(
        nodes,
        faces["PAD"],
        faces["DISC"],
        row_of,
        lambda place: np.cross(unit, place - np.array(through)),
        4e11,
        5e5,
    )
    return structure, known


def agree(structure, known, mass, stiffness, atol=1e-7):
    normals, tangentials, springs, preloads, speeds = known
    np.testing.assert_allclose(structure.normals, normals, atol=atol)
    np.testing.assert_allclose(structure.tangentials, tangentials, atol=atol)
    np.testing.assert_allclose(structure.stiffnesses, springs, rtol=1e-12)
    np.testing.assert_allclose(structure.preloads, preloads, rtol=1e-12)
    np.testing.assert_allclose(structure.speeds, speeds, rtol=10 * atol)
    values, forces = oracle.modes(
        mass, stiffness, normals, tangentials, springs, preloads, 0.5
    )
    assert (forces > 0).all()
    ours = structure.complex_modes(critical=False)
    np.testing.assert_allclose(ours.normal_force, forces, rtol=1e-6)
    theirs = np.sort(np.abs(values.imag))
    np.testing.assert_allclose(
        np.sort(ours.frequency.values), theirs / (2 * np.pi), rtol=1e-6
    )
    assert ours.growth_rate.max() == pytest.approx(
        values.real.max(), rel=1e-5, abs=1e-3
    )


@pytest.mark.parametrize(
    ("shape", "axis", "through"),
    [
        ({}, (0, 0, -1), (0, 0, 0)),
        pytest.param({"shift": 0.11}, (0, 0, -1), (0, 0, 0), marks=pytest.mark.release),
        ({"cone": 0.3}, (0, 0, 1), (0, 0, 0)),
        ({"cone": -0.2, "shift": 0.2}, (0.05, 0.02, 1), (0.01, 0, 0.02)),
    ],
    ids=["matching", "non-matching", "cone", "non-matching cone, skew axis"],
)
def test_brakes_agree_with_an_assembly_of_their_own(shape, axis, through):
    nodes, hexahedra, faces = oracle.brake(
        pad_r=(0, 1) if "shift" in shape else (0, 2), **shape
    )
    mass, stiffness = oracle.solid_matrices(nodes, hexahedra)
    agree(*both(nodes, faces, mass, stiffness, axis, through), mass, stiffness)


def test_deck_gives_what_arrays_give(tmp_path):
    nodes, hexahedra, faces = oracle.brake(cone=0.1)
    path = tmp_path / "brake.inp"
    path.write_text(oracle.deck(nodes, hexahedra, faces))
    mass, stiffness = oracle.solid_matrices(nodes, hexahedra)
    agree(*both(nodes, faces, mass, stiffness, (0, 0, 1), mesh=path), mass, stiffness)


def test_shell_on_a_solid_agrees_with_an_assembly_of_its_own():
    """A plate of triangles and quadrilaterals with six degrees of freedom a node, gap 2 mm."""
    nodes, hexahedra, faces = oracle.brake()
    solid, held = oracle.solid_matrices(nodes, hexahedra)
    plate = {
        9001: (0.07, -0.01, 0.002),
        9002: (0.09, -0.012, 0.002),
        9003: (0.11, -0.008, 0.002),
        9004: (0.072, 0.03, 0.002),
        9005: (0.091, 0.031, 0.002),
        9006: (0.1, 0.03, 0.002),
    }
    nodes |= {n: np.array(place) for n, place in plate.items()}
    faces["PAD"] = [[9001, 9004, 9005, 9002], [9002, 9005, 9006], [9002, 9006, 9003]]
    names = [(n, d) for n in nodes for d in range(1, 7 if n > 9000 else 4)]
    size, first = len(names), len(solid)
    mass, stiffness = np.eye(size), np.zeros((size, size))
    mass[:first, :first], stiffness[:first, :first] = solid, held
    draw = np.random.default_rng(5).normal(size=(36, 36))
    mass[first:, first:] = np.diag(0.02 + 0.01 * np.arange(36) / 36)
    stiffness[first:, first:] = 1e8 * (draw @ draw.T / 36 + np.eye(36))
    structure = Structure.from_mesh(
        mass,
        stiffness,
        mesh=(nodes, faces),
        contacts={
            "lining": Face("PAD", against="DISC", stiffness_per_area=4e11, pressure=5e5)
        },
        rotation=Rotation(axis=(0, 0, 1), speed=10.0),
        degrees_of_freedom=names,
        mu=0.5,
    )
    known = oracle.contacts(
        nodes,
        faces["PAD"],
        faces["DISC"],
        {name: row for row, name in enumerate(names)},
        lambda place: np.cross((0, 0, 1), place),
        4e11,
        5e5,
    )
    agree(structure, known, mass, stiffness)
    assert [each.origin.gap for each in structure.contacts] == pytest.approx(
        [0.002] * 6
    )
    assert [each.origin.nodes[0] for each in structure.contacts] == list(plate)
