"""Broken inputs of meshes and faces: each ends in one sentence with numbers and a remedy."""

import gzip
from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Face, Structure
from tests.oracles import mesh_contacts as oracle

NODES, HEXAHEDRA, FACES = oracle.brake()
DECK = oracle.deck(NODES, HEXAHEDRA, FACES)
NAMES = [f"{node}.{direction}" for node in NODES for direction in (1, 2, 3)]
YAML = """\
mass: M.mas
stiffness: M.sti
mesh: brake.inp
contacts:
  lining:
    surface: PAD
    against: DISC
    stiffness: 2 kN/mm
    pressure: 0.5 MPa
rotation: {axis: [0, 0, 1], through: [0, 0, 0], speed: 20 rad/s, body: DISC}
"""


def write_brake(folder):
    """A brake whose matrices are diagonal, with the mass of its volume in cast iron."""
    mass, _ = oracle.solid_matrices(NODES, HEXAHEDRA)
    lumped = mass.sum(axis=1)
    for name, values in (("M.mas", lumped), ("M.sti", np.full(len(lumped), 1e9))):
        rows = [f"{i} {i} {float(v)!r}" for i, v in enumerate(values, 1)]
        (folder / name).write_text("\n".join(rows) + "\n")
    (folder / "M.dof").write_text("\n".join(NAMES) + "\n")
    (folder / "brake.inp").write_text(DECK)
    (folder / "brake.yaml").write_text(YAML)


def replaced(file, old, new):
    """Spoil a file by replacing a text that it has."""

    def spoil(folder):
        content = (folder / file).read_text()
        assert old in content, (old, file)
        (folder / file).write_text(content.replace(old, new))

    return spoil


def yaml(old, new):
    return replaced("brake.yaml", old, new)


def deck(old, new):
    return replaced("brake.inp", old, new)


def appended(text):
    return lambda folder: (folder / "brake.inp").write_text(DECK + text)


def removed(file):
    return lambda folder: (folder / file).unlink()


def pad_moved(folder, by):
    lines = []
    for line in DECK.splitlines():
        cells = line.split(", ")
        if line.startswith("50") and len(cells) == 4:
            moved = [float(c) + b for c, b in zip(cells[1:], by, strict=True)]
            line = ", ".join([cells[0], *map(repr, moved)])
        lines.append(line)
    (folder / "brake.inp").write_text("\n".join(lines) + "\n")


def in_millimetres(folder):
    lines = []
    for line in DECK.splitlines():
        cells = line.split(", ")
        if len(cells) == 4 and cells[0].isdigit() and "." in cells[1]:
            line = ", ".join([cells[0], *(repr(1e3 * float(c)) for c in cells[1:])])
        lines.append(line)
    (folder / "brake.inp").write_text("\n".join(lines) + "\n")


def cut_off_gzip(folder):
    packed = gzip.compress((folder / "brake.inp").read_bytes())
    (folder / "brake.inp").write_bytes(packed[:-20])


def without_a_direction(folder):
    """The degrees of freedom of a pad's node are condensed by an equation."""
    drop = NAMES.index("5001.1")
    for name in ("M.mas", "M.sti"):
        rows = (folder / name).read_text().splitlines()
        values = [row.split()[2] for i, row in enumerate(rows) if i != drop]
        (folder / name).write_text(
            "".join(f"{i} {i} {v}\n" for i, v in enumerate(values, 1))
        )
    (folder / "M.dof").write_text("\n".join(n for n in NAMES if n != "5001.1"))
    appended("*EQUATION\n2\n5001, 1, 1., 5002, 1, -1.\n")(folder)


def swapped(folder):
    yaml("mass: M.mas", "mass: M.sti")(folder)
    yaml("stiffness: M.sti", "stiffness: M.mas")(folder)


def node_set_against(nodes):
    def spoil(folder):
        appended(f"*NSET, NSET=SOME\n{nodes}\n")(folder)
        yaml("against: DISC", "against: SOME")(folder)

    return spoil


def rows_added(folder, mass):
    """Two nodes that the mesh does not list, with a mass between them."""
    first = len(NAMES) + 1
    for file, block in (("M.mas", mass), ("M.sti", 1e9 * np.eye(2))):
        with (folder / file).open("a") as lines:
            for way in range(3):
                for i, j in ((0, 0), (1, 0), (1, 1)):
                    row, column = first + way + 3 * i, first + way + 3 * j
                    lines.write(f"{row} {column} {float(block[i, j])!r}\n")
    added = [f"{node}.{way}" for node in (6001, 6002) for way in (1, 2, 3)]
    (folder / "M.dof").write_text("\n".join([*NAMES, *added]) + "\n")


def of_incompatible_modes(folder):
    """CalculiX integrates their masses to one and the same number, as of ccx 2.20's C3D8I."""
    rows_added(folder, np.full((2, 2), 0.008))


def pressures(text):
    def spoil(folder):
        (folder / "p.txt").write_text(text)
        yaml("pressure: 0.5 MPa", "pressures: p.txt")(folder)

    return spoil


def scaled(file, factor):
    """Multiply the values of a matrix."""

    def spoil(folder):
        rows = [line.split() for line in (folder / file).read_text().splitlines()]
        (folder / file).write_text(
            "".join(f"{i} {j} {factor * float(v)!r}\n" for i, j, v in rows)
        )

    return spoil


BROKEN = [
    (
        replaced("M.dof", "5003.3", "5003.7"),
        r"5003.7 has no direction 7 \(1 rows\); 1 to 3 are displacements along",
    ),
    (scaled("M.mas", 0.0), "mass is 0 at all 198 degrees of freedom.*whole numbers"),
    (scaled("M.sti", -1.0), "stiffness is negative at all 198 .*: change its sign"),
    (
        yaml("mass: M.mas", "modal_damping: 2\nmass: M.mas"),
        "modal_damping = 2: ratios above 1 .*; 1 % is 0.01",
    ),
    (
        yaml("speed: 20 rad/s", "speed: 20,5 rad/s"),
        "'5 rad/s' is unknown; a comma begins another key; write a decimal point",
    ),
    (
        lambda folder: (folder / "brake.inp").write_bytes(b"\x81\x00" * 99),
        "'no text' stands before the first keyword",
    ),
    (
        lambda folder: (folder / "brake.yaml").write_text(YAML, "utf-16"),
        "byte 1 is not UTF-8; save the file in that encoding",
    ),
    (yaml("PAD", "LINING"), r"no surface or node set 'LINING'; .*(DISC|PAD)"),
    (yaml("against: DISC", "against: DSC"), r"no surface or node set 'DSC'.*DISC"),
    (yaml("body: DISC", "body: WHEEL"), "no surface or node set 'WHEEL'"),
    (yaml("pressure: 0.5 MPa", "pressure: 0"), "pressure = 0: .*nothing presses"),
    (yaml("pressure: 0.5 MPa", "pressure: 0.5 N"), "pressure"),
    (yaml("pressure: 0.5 MPa", "force: -3 N"), "force = -3: must be greater than 0"),
    (yaml("    pressure: 0.5 MPa\n", ""), "pressure is missing; give it, or force"),
    (yaml("    stiffness: 2 kN/mm\n", ""), "stiffness is missing"),
    (yaml("2 kN/mm", "2 kN"), "stiffness = '2 kN'"),
    (yaml("pressure:", "presure:"), "'presure' is unknown; did you mean 'pressure'"),
    (yaml("against: DISC", "against: PAD"), "cannot rub against itself"),
    (yaml("speed: 20 rad/s", "speed: 0"), "speed = 0: nothing slides"),
    (yaml("speed: 20 rad/s", "speed: 2 m/s"), "rotation: speed = '2 m/s'"),
    (
        yaml("through: [0, 0, 0]", "through: [3 mm, 0, 0]"),
        r"rotation: through = .*: plain numbers .*\(1 is 1 m\)",
    ),
    (
        yaml("axis: [0, 0, 1]", "axis: [0, 0, 0]"),
        r"axis = \[0, 0, 0\] points nowhere: a direction",
    ),
    (
        swapped,
        "mass: .*M.sti is the stiffness that CalculiX writes; exchange the two names",
    ),
    (
        node_set_against("1, 2, 3"),
        "node set SOME has no facets: .*all of its nodes in it",
    ),
    (
        of_incompatible_modes,
        "6 rows of the matrices are of nodes 6001 to 6002, .*C3D8I.*with C3D8, C3D20",
    ),
    (yaml("axis", "axle"), "'axle' is unknown; did you mean 'axis'"),
    (
        yaml("through: [0, 0, 0]", "through: [0.06, 0, 0]"),
        r"axis of rotation goes through PAD at node 5001 .*(where nothing slides).*through",
    ),
    (
        yaml(
            "axis: [0, 0, 1], through: [0, 0, 0]", "axis: [1, 0, 0], through: [0, 0, 0]"
        ),
        "moves along its normal at node|axis of rotation goes through",
    ),
    (
        replaced("brake.yaml", YAML.splitlines()[-1], ""),
        "nothing says how DISC moves; give a rotation",
    ),
    (yaml("mesh: brake.inp", "mesh: disc.inp"), "mesh: no file .*disc.inp"),
    (yaml("mesh: brake.inp\n", ""), "faces of a mesh, which is missing"),
    (
        removed("M.dof"),
        "degrees_of_freedom is missing: .*198 rows.* 66 nodes; .*brake.dof",
    ),
    (
        yaml("mesh:", "degrees_of_freedom: other.dof\nmesh:"),
        "degrees_of_freedom: no file .*other.dof",
    ),
    (
        lambda folder: (folder / "M.dof").write_text("\n".join(NAMES[:-1])),
        "mass has 198 rows, but 197 have names .*written together",
    ),
    (
        replaced("M.dof", "5003.2", "5003.1"),
        "5003.1 .*twice, as are 0 more; .*expands shells",
    ),
    (
        lambda folder: (folder / "M.dof").write_text(
            "\n".join(f"{70000 + i}.1" for i in range(len(NAMES)))
        ),
        "none is in both",
    ),
    (
        lambda folder: pad_moved(folder, (0, 0, 0.2)),
        "9 of 9 nodes have no partner on DISC within .*node 5009 is 0.2 m from it",
    ),
    (
        lambda folder: pad_moved(folder, (0.5, 0, 0)),
        "nodes have no partner on DISC within",
    ),
    (in_millimetres, r"do not have the same units: .* kg/m³; state the units"),
    (yaml("mass: M.mas", "units: mm-t-s\nmass: M.mas"), "do not have the same units"),
    (deck("*SURFACE, NAME=PAD", "*SURFACE, NAME=DISC"), "surface DISC is there twice"),
    (
        appended("*NODE\n5001, 0.0, 0.0, 0.5\n"),
        r"node 5001 is there twice, at \(0.06, 0, 0\) and \(0, 0, 0.5\)",
    ),
    (appended("*ELEMENT, TYPE=C3D8\n1, 1,2,3,4,5,6,7,8\n"), "element 1 is there twice"),
    (
        appended("*ELEMENT, TYPE=C3D8\n99, 1,2,3,4,5,6,7\n"),
        "element 99 has 7 nodes, .*8",
    ),
    (
        appended("*ELEMENT, TYPE=C3D8\n99, 1,2,3,4,5,6,7,777\n"),
        "element 99 has node 777, which no",
    ),
    (appended("*INCLUDE, INPUT=more.inp\n"), "no file .*more.inp"),
    (appended("*INCLUDE, INPUT=brake.inp\n"), "includes itself"),
    (appended("*NGEN\n1, 9, 1\n"), "NGEN makes nodes that the deck does not list"),
    (
        appended("*INSTANCE, NAME=A, PART=B\n0., 0., 1.\n"),
        "INSTANCE: parts that are moved",
    ),
    (appended("*SYSTEM\n1., 0., 0.\n"), "coordinate system of their own"),
    (
        appended("*TRANSFORM, NSET=ALL, TYPE=C\n0,0,0,0,0,1\n"),
        r"node \d+ has directions of its",
    ),
    (deck("*Node, nset=all", "*NODE, SYSTEM=C"), "coordinate system of their own"),
    (deck("5001, 0.06, 0.0", "5001; 0.06; 0.0"), "no node; its number and three"),
    (deck("*HEADING", "HEADING"), "before the first keyword"),
    (
        deck("*SURFACE, NAME=PAD, TYPE=ELEMENT", "*SURFACE, NAME=PAD, TYPE=CYLINDER"),
        "TYPE=CYLINDER: only surfaces of elements and of nodes",
    ),
    (deck("NAME=PAD, TYPE=ELEMENT\n", "NAME=PAD, TYPE=ELEMENT\n1, S7\n"), "no face S7"),
    (
        deck("NAME=PAD, TYPE=ELEMENT\n", "NAME=PAD, TYPE=ELEMENT\n888, S1\n"),
        "no element 888",
    ),
    (
        deck("NAME=PAD, TYPE=ELEMENT\n", "NAME=PAD, TYPE=ELEMENT\nSHOE, S1\n"),
        "set SHOE",
    ),
    (
        # the pad's back in place of its front
        deck("S1\n", "S2\n"),
        r"do not face each other at .*apart|no partner on",
    ),
    (cut_off_gzip, "packed by gzip but damaged"),
    (without_a_direction, r"node 5001 has no degree of freedom 5001.1.*\*EQUATION"),
    (
        pressures("5001 1e5\n5002 1e5\n"),
        "7 nodes of PAD have none, node 5003 the first",
    ),
    (pressures("5001 1e5\n5001 2e5\n"), "line 2: 5001 is there twice"),
    (pressures("5001\n"), "a node and its pressure are needed"),
    (
        pressures("".join(f"{n} 0\n" for n in NODES if n > 5000)),
        "pressures: 0 at node 5001; .* greater than 0 somewhere",
    ),
    (yaml("contacts:\n  lining:", "contacts:\n  lining 1:"), "letters, digits and _"),
    (yaml("surface: PAD", "points: 2.5\n    surface: PAD"), "points = 2.5"),
    (yaml("surface: PAD", "mu: -1\n    surface: PAD"), "mu = -1"),
    (
        yaml("surface: PAD", "direction: [1, 0, 0]\n    surface: PAD"),
        "direction and rotation are both given",
    ),
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    write_brake(folder)
    return folder


def test_the_brake_that_is_spoilt_below_is_whole(whole):
    structure = Structure.read(whole / "brake.yaml")
    assert len(structure.contacts) == 9
    assert structure.preloads.sum() > 0


def test_rows_of_nodes_that_no_mesh_lists_are_kept(whole, tmp_path):
    for file in whole.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    rows_added(tmp_path, np.diag([1.0, 1e3]))
    structure = Structure.read(tmp_path / "brake.yaml")
    assert structure.size == len(NAMES) + 6
    assert structure.names[-6:] == tuple(
        f"row {len(NAMES) + row}" for row in range(1, 7)
    )


@pytest.mark.parametrize(("spoil", "words"), BROKEN)
def test_broken_input_ends_in_one_sentence(whole, tmp_path, spoil, words):
    for file in whole.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    spoil(tmp_path)
    with pytest.raises((ValueError, FileNotFoundError), match=words) as caught:
        Structure.read(tmp_path / "brake.yaml")
    text = str(caught.value).removeprefix("the configuration has mistakes:\n")
    assert "\n" not in text
    assert "Traceback" not in text


FACE = Face("foot", stiffness=1e8, pressure=1e5, direction=[1, 0, 0])
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
FOOT = {"foot": [[0, 3, 2, 1]]}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mesh": 3}, "a file, a mesh of meshio, or"),
        ({"mesh": (SQUARE[:, :2], FOOT)}, "shape"),
        ({"mesh": (SQUARE, {"foot": [[0, 1, 9]]})}, "facet of foot has node 9"),
        ({"mesh": (SQUARE, {"foot": [[0, 1]]})}, "3, 4, 6 or 8 nodes"),
        ({"mesh": (SQUARE, [[0, 1, 2]])}, "name: facets"),
        (
            {"mesh": (SQUARE, {"foot": [[0, 3, 2], [0, 1, 2]]})},
            "look in opposite directions",
        ),
        (
            {
                "mesh": (SQUARE, FOOT | {"belt_side": [[0, 1, 2, 3]]}),
                "contacts": {
                    "f": Face(
                        "foot",
                        against="belt_side",
                        stiffness=1e8,
                        pressure=1e5,
                        direction=[1, 0, 0],
                    )
                },
            },
            "foot and belt_side share 4 nodes, 1 the first",
        ),
        ({"contacts": [FACE]}, "name: Face"),
        ({"contacts": {"f": "foot"}}, "name: Face"),
        ({"rotation": 20.0}, "Rotation is needed"),
        ({"degrees_of_freedom": ["1.1"]}, "1 rows, but the matrices have 12"),
        ({"degrees_of_freedom": ["a"] * 12}, "'a' is no node with its direction"),
        ({"degrees_of_freedom": 3}, "degrees_of_freedom = 3"),
        ({"units": "mm"}, "length, mass and time"),
        ({"mass": np.eye(11), "stiffness": np.eye(11)}, "11 rows without names"),
    ],
)
def test_wrong_arguments_of_python_are_named(changes, words):
    given = {
        "mass": np.eye(12),
        "stiffness": np.eye(12),
        "mesh": (SQUARE, FOOT),
        "contacts": {"f": FACE},
        **changes,
    }
    with pytest.raises(ValueError, match=words):
        Structure.from_mesh(**given)


def test_a_contact_far_stiffer_than_the_bodies_is_refused_with_a_stiffness_that_works(
    whole, tmp_path
):
    """The remedy was to add supports."""
    for file in whole.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    yaml("2 kN/mm", "1e30 kN/mm")(tmp_path)
    structure = Structure.read(tmp_path / "brake.yaml")
    with pytest.raises(
        ValueError, match=r"contacts are as stiff as .*no digit"
    ) as told:
        structure.complex_modes(mu=0.3)
    rigid = float(str(told.value).rsplit("rigid from ", 1)[1].split()[0])
    firm = [replace(each, stiffness=rigid) for each in structure.contacts]
    modes = structure.with_(contacts=firm).complex_modes(mu=0.3, critical=False)
    assert (modes.normal_force > 0).any()
