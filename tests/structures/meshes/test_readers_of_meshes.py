"""Decks, .msh and .bdf: numbers of nodes, surfaces and their outward sides."""

import gzip
from itertools import product

import meshio
import numpy as np
import pytest

from squealpipe import Face, Structure
from squealpipe.structures.meshes.shape_functions import normal_integrals, shares
from squealpipe.structures.meshes.sources import mesh_of_source
from tests.oracles import mesh_contacts as oracle


def outward(mesh, name):
    """∫ n dA of a surface and the numbers of its nodes."""
    facets = mesh.surface(name).facets
    total = sum(
        normal_integrals(mesh.nodes[rows]).sum(axis=0) for rows in facets.values()
    )
    numbers = {
        int(mesh.numbers[node]) for rows in facets.values() for node in rows.ravel()
    }
    return total, numbers


def cube(quadratic, kind):
    """A unit cube as one hexahedron or six tetrahedra, nodes numbered from 101 by tens."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corners += [(x, y, 1) for x, y, _ in corners]
    points = [np.array(each, float) for each in corners]
    if kind == "hexahedron":
        elements = [list(range(8))]
        edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
        edges += [(0, 4), (1, 5), (2, 6), (3, 7)]
    else:
        elements = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6]]
        elements += [[0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
        edges = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    if quadratic:
        middles = {}
        for row in elements:
            for a, b in edges:
                key = frozenset((row[a], row[b]))
                if key not in middles:
                    middles[key] = len(points)
                    points.append(0.5 * (points[row[a]] + points[row[b]]))
        elements = [
            row + [middles[frozenset((row[a], row[b]))] for a, b in edges]
            for row in elements
        ]
    numbers = [101 + 10 * place for place in range(len(points))]
    return numbers, points, [[numbers[place] for place in row] for row in elements]


TYPES = {
    ("hexahedron", False): "C3D8I",
    ("hexahedron", True): "C3D20R",
    ("tetra", False): "C3D4",
    ("tetra", True): "C3D10M",
}


@pytest.mark.parametrize(("kind", "quadratic"), list(TYPES))
def test_every_solid_has_its_outward_faces_by_node_sets_and_by_names(
    tmp_path, kind, quadratic
):
    numbers, points, elements = cube(quadratic, kind)
    lines = ["*NODE"]
    lines += [f"{n},{x},{y},{z}" for n, (x, y, z) in zip(numbers, points, strict=True)]
    lines.append(f"*ELEMENT, TYPE={TYPES[kind, quadratic]}, ELSET=CUBE")
    for number, row in enumerate(elements, 1):
        # long ones go on in the next line, with or without a comma at the end
        words = list(map(str, [number, *row]))
        lines += [", ".join(words[:12]) + ("," if number % 2 else "")]
        lines += [", ".join(words[12:])] if words[12:] else []
    sides = {"LOW": (2, 0), "HIGH": (2, 1), "LEFT": (0, 0), "BACK": (1, 1)}
    for name, (axis, value) in sides.items():
        members = [n for n, p in zip(numbers, points, strict=True) if p[axis] == value]
        lines += [f"*NSET, NSET={name}", ",".join(map(str, members))]
    lines += ["*SURFACE, NAME=SKIN", "CUBE"]
    path = tmp_path / "cube.inp.gz"
    path.write_bytes(gzip.compress("\n".join(lines).encode()))
    mesh = mesh_of_source(path)
    assert mesh.volume == pytest.approx(1.0)
    for name, (axis, value) in sides.items():
        total, found = outward(mesh, name.lower())
        expected = np.zeros(3)
        expected[axis] = 1.0 if value else -1.0
        np.testing.assert_allclose(total, expected, atol=1e-14)
        assert found == {
            n for n, p in zip(numbers, points, strict=True) if p[axis] == value
        }
    whole = mesh.surface("SKIN").facets
    assert sum(
        shares(mesh.nodes[rows]).sum() for rows in whole.values()
    ) == pytest.approx(6.0)
    np.testing.assert_allclose(outward(mesh, "SKIN")[0], 0.0, atol=1e-14)


def test_mirrored_elements_have_outward_faces_too(tmp_path):
    nodes, hexahedra, faces = oracle.brake()
    mirrored = [row[4:] + row[:4] for row in hexahedra]
    path = tmp_path / "brake.inp"
    path.write_text(
        oracle.deck(nodes, mirrored, {})
        + "*NSET, NSET=TOP\n"
        + ",\n".join(map(str, sorted({n for facet in faces["DISC"] for n in facet})))
    )
    total, _ = outward(mesh_of_source(path), "TOP")
    assert total[2] > 0.02


SHELLS = """\
*INCLUDE, INPUT=nodes.inp
*ELEMENT, TYPE=S4R, ELSET=PLATE
1, 1, 2, 3, 4
*ELEMENT, TYPE=S3, ELSET=PLATE
2, 2, 5, 3
*ELEMENT, TYPE=SPRING1, ELSET=S
9, 1
*ELEMENT, TYPE=MASS
10, 2
*ELEMENT, TYPE=B31
11, 1, 2
*NSET, NSET=ALL, GENERATE
1, 5, 1
*ELSET, ELSET=BOTH, GENERATE
1, 2, 1
*ELSET, ELSET=AGAIN
BOTH
*SURFACE, NAME=TOP
AGAIN, SPOS
*SURFACE, NAME=BOTTOM
1, SNEG
2, SNEG
*SURFACE, NAME=SPRING
S, S1
"""


def test_shells_have_two_sides_and_what_has_no_face_is_skipped(tmp_path):
    (tmp_path / "nodes.inp").write_text(
        "*NODE, NSET=N\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,2,0,0\n"
    )
    path = tmp_path / "plate.inp"
    path.write_text(SHELLS)
    mesh = mesh_of_source(path)
    np.testing.assert_allclose(outward(mesh, "TOP")[0], [0, 0, 1.5])
    np.testing.assert_allclose(outward(mesh, "bottom")[0], [0, 0, -1.5])
    assert outward(mesh, "ALL")[1] == {1, 2, 3, 4, 5}
    assert not mesh.surface("PLATE").has_side
    with pytest.raises(ValueError, match="element 9 is SPRING1, which has no face"):
        mesh.surface("SPRING")


def test_shells_without_a_side_are_turned_to_face_the_other_surface(tmp_path):
    numbers, points, elements = cube(False, "hexahedron")
    text = "*NODE\n"
    text += "".join(
        f"{n},{x},{y},{z}\n" for n, (x, y, z) in zip(numbers, points, strict=True)
    )
    text += "".join(
        f"{n},{x},{y},1.01\n"
        for n, (x, y) in enumerate([(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8)], 1)
    )
    text += "*ELEMENT, TYPE=C3D8\n1," + ",".join(map(str, elements[0])) + "\n"
    text += "*SURFACE, NAME=TOP\n1, S2\n*ELEMENT, TYPE=S4, ELSET=PLATE\n2, {}\n"
    normals = []
    for order in ("1,2,3,4", "4,3,2,1"):
        path = tmp_path / "plate.inp"
        path.write_text(text.format(order))
        names = [(n, d) for n in (1, 2, 3, 4, *numbers) for d in (1, 2, 3)]
        structure = Structure.from_mesh(
            np.eye(len(names)),
            np.eye(len(names)),
            mesh=path,
            degrees_of_freedom=names,
            contacts={
                "f": Face(
                    "PLATE", against="TOP", stiffness=1e6, force=10, direction=[1, 0, 0]
                )
            },
        )
        normals.append(structure.normals)
    np.testing.assert_allclose(normals[0], normals[1])
    assert normals[0][2, 0] == 1.0


def gmsh_files(folder):
    """The same cube and its low side as gmsh writes it, versions 2.2 and 4.1, sparse numbers."""
    numbers, points, elements = cube(False, "hexahedron")
    row = " ".join(map(str, elements[0]))
    low = " ".join(map(str, elements[0][:4]))
    places = [" ".join(map(str, each)) for each in points]
    names = '$PhysicalNames\n2\n2 7 "LOW SIDE"\n3 1 "body"\n$EndPhysicalNames\n'
    pairs = "\n".join(f"{n} {p}" for n, p in zip(numbers, places, strict=True))
    (folder / "v2.msh").write_text(
        f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n8\n{pairs}\n$EndNodes\n"
        f"$Elements\n2\n1 3 2 7 1 {low}\n2 5 2 1 1 {row}\n$EndElements\n"
    )
    first, second = ("\n".join(map(str, part)) for part in (numbers[:4], numbers[4:]))
    (folder / "v4.msh").write_text(
        f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}$Entities\n0 0 1 1\n"
        "1 0 0 0 1 1 0 1 7 0\n1 0 0 0 1 1 1 1 1 1 1\n$EndEntities\n"
        f"$Nodes\n2 8 {numbers[0]} {numbers[-1]}\n2 1 0 4\n{first}\n"
        + "\n".join(places[:4])
        + f"\n3 1 0 4\n{second}\n"
        + "\n".join(places[4:])
        + "\n$EndNodes\n"
        f"$Elements\n2 2 1 2\n2 1 3 1\n1 {low}\n3 1 5 1\n2 {row}\n$EndElements\n"
    )
    return numbers


@pytest.mark.parametrize("file", ["v2.msh", "v4.msh"])
def test_gmsh_keeps_numbers_and_named_surfaces(tmp_path, file):
    numbers = gmsh_files(tmp_path)
    mesh = mesh_of_source(tmp_path / file)
    assert mesh.numbers.tolist() == numbers
    total, found = outward(mesh, "low side")
    np.testing.assert_allclose(total, [0, 0, -1], atol=1e-15)
    assert found == set(numbers[:4])
    assert mesh.surface("LOW SIDE").has_side
    assert len(mesh.skin[4]) == 6


def test_binary_gmsh_is_refused_with_its_remedy(tmp_path):
    numbers, points, elements = cube(False, "hexahedron")
    order = {n: place for place, n in enumerate(numbers)}
    cells = [("hexahedron", [[order[n] for n in elements[0]]])]
    meshio.Mesh(np.array(points), cells).write(tmp_path / "b.msh", file_format="gmsh22")
    with pytest.raises(ValueError, match=r"Mesh\.Binary = 0"):
        mesh_of_source(tmp_path / "b.msh")


BULK = """\
GRID    101             0.00E+000.00E+000.00E+00
GRID    111             1.0000000.00E+000.00E+00
GRID    121             1.0000001.0000000.00E+00
GRID    131             0.00E+001.0000000.00E+00
GRID,141,,0.,0.,1.
GRID,151,,1.,0.,1.
GRID*                161                              1.              1.
*                     1.
GRID    171             0.      1.      1.      {cd}
CHEXA   1       1       101     111     121     131     141     151
+       161     171
CQUAD4  2       7       141     151     161     171
CELAS1  3       9       101     1
"""


@pytest.mark.parametrize("framed", [True, False])
def test_nastran_keeps_numbers_and_names_surfaces_by_property(tmp_path, framed):
    text = BULK.format(cd="")
    path = tmp_path / "cube.bdf"
    path.write_text(f"SOL 103\nCEND\nBEGIN BULK\n{text}ENDDATA\n" if framed else text)
    mesh = mesh_of_source(path)
    assert mesh.numbers.tolist() == [101, 111, 121, 131, 141, 151, 161, 171]
    total, found = outward(mesh, "7")
    np.testing.assert_allclose(total, [0, 0, 1], atol=1e-15)
    assert found == {141, 151, 161, 171}
    assert mesh.volume == pytest.approx(1.0)


def test_nastrans_systems_of_coordinates_are_refused(tmp_path):
    path = tmp_path / "cube.bdf"
    path.write_text(BULK.format(cd="4"))
    with pytest.raises(
        ValueError, match="GRID 171 has displacements in a coordinate system"
    ):
        mesh_of_source(path)
    path.write_text("INCLUDE 'more.bdf'\n" + BULK.format(cd=""))
    with pytest.raises(ValueError, match=r"another file \(INCLUDE\)"):
        mesh_of_source(path)
    path.write_text(BULK.format(cd="").replace("GRID    111     ", "GRID    111     5"))
    with pytest.raises(ValueError, match="GRID cards in coordinate system 5"):
        mesh_of_source(path)


def test_a_mesh_of_meshio_with_its_sets_is_taken_as_it_is():
    numbers, points, elements = cube(False, "hexahedron")
    order = {n: place for place, n in enumerate(numbers)}
    row = [order[n] for n in elements[0]]
    mesh = meshio.Mesh(
        np.array(points),
        [("hexahedron", [row]), ("quad", [row[4:], row[3::-1]])],
        cell_sets={"top": [np.array([], int), np.array([0])]},
        point_sets={"low": np.array(row[:4])},
    )
    source = mesh_of_source(mesh)
    np.testing.assert_allclose(outward(source, "top")[0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(outward(source, "low")[0], [0, 0, -1], atol=1e-15)
    structure = Structure.from_mesh(
        1e3 / 8 * np.eye(24),
        np.eye(24),
        mesh=mesh,
        contacts={"f": Face("low", stiffness=1.0, force=4.0, direction=[0, 1, 0])},
    )
    np.testing.assert_allclose(structure.preloads, 1.0)
    assert structure.names[:4] == ("1.1", "1.2", "1.3", "2.1")


def test_what_meshio_cannot_read_is_said_with_its_words(tmp_path):
    for name, content in product(("a.msh", "a.bdf", "a.xyz"), ("nothing", "")):
        (tmp_path / name).write_text(content)
        with pytest.raises(ValueError, match=r"meshio cannot read .*a deck"):
            mesh_of_source(tmp_path / name)
