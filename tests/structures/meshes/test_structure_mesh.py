"""The mesh of a structure, and of its datasets."""

import numpy as np
import pytest

from squealpipe import Structure
from squealpipe.structures import elastic_pad
from squealpipe.structures.meshes.datasets import mesh_of
from squealpipe.structures.meshes.structure_mesh import StructureMesh


@pytest.fixture(scope="module")
def pad():
    return elastic_pad(elements=(4, 2), contacts=3)


def test_pad_turned_as_a_whole_moves_its_nodes_around_their_center(pad):
    x, y, _ = pad.mesh.nodes.T
    turn = np.where(
        pad.mesh.degree_of_freedom[:, 1] == 1,
        -y[pad.mesh.degree_of_freedom[:, 0]],
        x[pad.mesh.degree_of_freedom[:, 0]],
    )
    moved = pad.mesh.displacements(turn)
    np.testing.assert_allclose(moved, np.column_stack([-y, x, 0.0 * x]))
    # the stiffness sees no strain in it but that of the springs along the upper edge
    assert abs(turn @ (pad.stiffness @ turn)) < 1e-3 * turn @ turn * 8e9


def test_facets_of_the_pad_cover_its_area(pad):
    corners = pad.mesh.nodes[pad.mesh.facets][:, :, :2]
    following = np.roll(corners, -1, axis=1)
    area = 0.5 * np.cross(
        np.pad(corners, ((0, 0), (0, 0), (0, 1))),
        np.pad(following, ((0, 0), (0, 0), (0, 1))),
    )[..., 2].sum(axis=1)
    assert abs(area).sum() == pytest.approx(0.06 * 0.015, rel=1e-12)


def test_datasets_hold_the_mesh_and_where_contacts_are(pad):
    modes = pad.complex_modes(mu=0.3, n_modes=3, critical=False)
    np.testing.assert_allclose(
        modes.contact_position, [[0, 0, 0], [0.03, 0, 0], [0.06, 0, 0]], atol=1e-15
    )
    mesh = mesh_of(modes)
    for key in ("nodes", "facets", "degree_of_freedom", "numbers"):
        np.testing.assert_array_equal(getattr(mesh, key), getattr(pad.mesh, key))


def test_reduced_pad_has_the_mesh_of_the_whole(pad):
    reduced = pad.reduce(n_modes=8)
    modes = reduced.complex_modes(mu=0.3, n_modes=3, critical=False)
    assert mesh_of(modes).names == pad.mesh.names
    assert modes.contact_position.notnull().all()
    moved = reduced.mesh.displacements(reduced.modes)
    assert moved.shape == (15, 3, 8)
    assert reduced.with_(mu=0.1).mesh is pad.mesh


def test_structure_without_mesh_has_none_in_its_dataset():
    modes = Structure(np.eye(2), np.eye(2)).complex_modes()
    assert mesh_of(modes) is None


def test_facets_of_several_lengths_and_a_plane_mesh():
    mesh = StructureMesh(
        [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0]],
        [np.array([[0, 1, 2, 3]]), [1, 4, 2]],
        [[0, 1], [-1, 3]],
        [11, 12, 13, 14, 15],
    )
    np.testing.assert_array_equal(mesh.facets, [[0, 1, 2, 3], [1, 4, 2, -1]])
    assert mesh.nodes.shape == (5, 3)
    assert mesh.displacements([1.0, 2.0])[0, 0] == 1.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"nodes": [1.0, 2.0]}, "shape"),
        ({"nodes": [[0.0, np.nan, 0.0]]}, "not finite"),
        ({"facets": [[0, 1, 7]]}, "0 to 1"),
        ({"degree_of_freedom": [1, 2]}, r"\(n, 2\)"),
        ({"numbers": [1]}, "1 numbers of 2 nodes"),
    ],
)
def test_mesh_of_wrong_arrays_is_refused(changes, words):
    arguments = {
        "nodes": np.zeros((2, 3)),
        "facets": [[0, 1]],
        "degree_of_freedom": [[0, 1]],
        **changes,
    }
    with pytest.raises(ValueError, match=words):
        StructureMesh(**arguments)


def test_mesh_of_other_degrees_of_freedom_is_refused():
    mesh = StructureMesh(np.zeros((1, 3)), [[0]], [[0, 1]])
    with pytest.raises(ValueError, match=r"1 degrees of freedom.*matrices have 2"):
        Structure(np.eye(2), np.eye(2), mesh=mesh)
