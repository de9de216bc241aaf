"""The brake that CalculiX assembled, from its own files and twelve lines of YAML."""

import gzip
import shutil
from pathlib import Path

import numpy as np
import pytest

from squealpipe import Contact, Face, Rotation, Structure
from squealpipe.structures import elastic_pad

DATA = Path(__file__).parent / "calculix_brake"
YAML = """\
units: mm-t-s
mass: brake.mas.gz
stiffness: brake.sti.gz
mesh: brake.inp.gz
contacts:
  lining:
    surface: PAD_FACE
    against: DISC_FACE
    stiffness: 2.5e6 N/mm
    pressure: 0.5 MPa
    mu: 0.4
rotation: {axis: [0, 0, 1], through: [0, 0, 0], speed: 20 rad/s, body: DISC_FACE}
"""
FORCES = [
    49.7169,
    104.0425,
    107.8794,
    51.8681,
    62.4086,
    135.4956,
    142.2804,
    68.0691,
    50.6094,
    113.4841,
    132.7012,
    72.6386,
    40.3678,
    93.8378,
    123.3812,
    75.8070,
    10.6626,
    27.0641,
    38.1479,
    24.2582,
]
"""Own assembly in scipy, friction along ω × r on the pad, against it on the disc, N."""


@pytest.fixture(scope="module")
def brake(tmp_path_factory):
    folder = tmp_path_factory.mktemp("brake")
    for file in DATA.iterdir():
        shutil.copy(file, folder)
    (folder / "brake.yaml").write_text(YAML)
    return Structure.read(folder / "brake.yaml")


def test_face_has_its_area_and_its_points_in_the_order_of_nodes(brake):
    assert [each.name for each in brake.contacts] == [
        f"lining_{number}" for number in range(1, 21)
    ]
    nodes = [each.origin.nodes[0] for each in brake.contacts]
    assert nodes == sorted(nodes)
    area = sum(each.origin.area for each in brake.contacts)
    assert area * 1e6 == pytest.approx(3047.5255, abs=5e-5)
    assert brake.stiffnesses.sum() == pytest.approx(2.5e9, rel=1e-12)
    assert brake.preloads.sum() == pytest.approx(0.5e6 * area, rel=1e-12)
    assert all(each.mu == 0.4 for each in brake.contacts)
    radii = np.linalg.norm([each.origin.position for each in brake.contacts], axis=1)
    np.testing.assert_allclose(brake.speeds, radii, rtol=1e-12)
    assert brake.belt_speed == 20.0


def test_forces_of_steady_sliding_and_the_mode_that_grows(brake):
    modes = brake.complex_modes(frequency_max=3000, critical=False)
    np.testing.assert_allclose(modes.normal_force, FORCES, atol=6e-5)
    grows = modes.unstable.values
    assert modes.growth_rate.values[grows] == pytest.approx([24.940579], abs=1e-6)
    assert modes.frequency.values[grows] == pytest.approx([2851.938816], rel=1e-9)
    assert modes.sizes["axis"] == 3
    assert modes.attrs["open_contacts"] == "none"


def test_backwards_the_disc_unloads_the_other_end(brake):
    """The mesh is its own mirror image: backwards, forces are those of the mirrored points."""
    backwards = brake.with_(belt_speed=-20.0)
    modes = backwards.complex_modes(frequency_max=1000, critical=False)
    mirrored = np.reshape(FORCES, (5, 4))[::-1].ravel()
    np.testing.assert_allclose(modes.normal_force, mirrored, atol=6e-5)


@pytest.mark.release
def test_modes_without_and_with_more_friction(brake):
    modes = brake.complex_modes(
        mu={"lining": [0.0, 0.6]}, frequency_max=3000, critical=False
    )
    rest = modes.isel(mu=0)
    assert not rest.unstable.any()
    lowest = np.sort(rest.frequency.values)[:4]
    np.testing.assert_allclose(
        lowest, [1918.1344, 2242.7044, 2259.5127, 2302.5501], rtol=3e-8
    )
    more = modes.isel(mu=1)
    grows = more.unstable.values
    assert more.growth_rate.values[grows] == pytest.approx([98.243300], abs=1e-6)
    assert more.frequency.values[grows] == pytest.approx([2853.365890], rel=1e-9)


def test_python_gives_the_same_structure(brake):
    rotation = Rotation(speed=20, body="DISC_FACE")
    face = Face(
        "pad_face",
        against="disc_face",
        stiffness="2.5e6 N/mm",
        force=f"{float(brake.preloads.sum())!r} N",
        mu=0.4,
    )
    other = Structure.from_mesh(
        DATA / "brake.mas.gz",
        DATA / "brake.sti.gz",
        mesh=DATA / "brake.inp.gz",
        contacts={"lining": face},
        rotation=rotation,
        units="mm-t-s",
    )
    np.testing.assert_allclose(other.normals, brake.normals)
    np.testing.assert_allclose(other.tangentials, brake.tangentials)
    np.testing.assert_allclose(other.preloads, brake.preloads, rtol=1e-12)
    assert other.mesh.names == brake.mesh.names


def test_mesh_of_the_brake_names_its_degrees_of_freedom(brake):
    names = gzip.decompress((DATA / "brake.dof.gz").read_bytes()).decode().split()
    assert brake.mesh.names == names
    assert len(brake.mesh.facets) == 498
    normal = brake.contacts[0].direction("normal", brake.size)
    assert {names[place] for place in np.flatnonzero(normal)} == {"5001.3", "362.3"}


def test_table_of_contacts_is_read_back_to_the_same_numbers(brake, tmp_path):
    table = tmp_path / "contacts.csv"
    brake.write_contacts(table)
    assert "362.3:-1.0 5001.3:1.0" in table.read_text()
    for file in ("brake.mas.gz", "brake.sti.gz", "brake.dof.gz"):
        shutil.copy(DATA / file, tmp_path)
    head, _, rest = YAML.partition("mesh:")
    (tmp_path / "brake.yaml").write_text(
        head + "contacts: contacts.csv\n" + rest[rest.index("rotation") :]
    )
    back = Structure.read(tmp_path / "brake.yaml")
    assert back.names == brake.names
    for name in ("normals", "tangentials", "stiffnesses", "preloads", "speeds"):
        np.testing.assert_array_equal(getattr(back, name), getattr(brake, name))
    assert [each.mu for each in back.contacts] == [0.4] * 20
    assert [each.origin for each in back.contacts] == [
        each.origin for each in brake.contacts
    ]
    again = tmp_path / "again.csv"
    back.write_contacts(again)
    assert again.read_text() == table.read_text()
    with pytest.raises(ValueError, match="write those of the whole"):
        elastic_pad(elements=(4, 1)).reduce(n_modes=6).write_contacts(again)


def test_contacts_may_name_degrees_of_freedom(brake):
    by_name = Contact("a", {"5001.3": 1.0, "362.3": -1.0}, {"5001.2": 1.0}, 1e8, 10.0)
    structure = brake.with_(contacts=[by_name])
    row = brake.names.index("362.3")
    assert structure.normals[row, 0] == -1.0
    wrong = Contact("a", {"5001.7": 1.0}, {0: 1.0}, 1e8, 10.0)
    with pytest.raises(ValueError, match=r"no degree of freedom '5001.7'.*like 2\.1"):
        brake.with_(contacts=[wrong])


def test_messages_name_nodes(brake):
    mass = brake.mass.tolil()
    row = brake.names.index("5003.2")
    mass[row, :] = 0.0
    mass[:, row] = 0.0
    with pytest.raises(ValueError, match=r"1 degrees of freedom have none \(5003.2\)"):
        brake.with_(mass=mass)


@pytest.mark.parametrize(
    "points", [3, *(pytest.param(n, marks=pytest.mark.release) for n in (1, 8))]
)
def test_points_merged_afterwards_are_those_merged_from_the_mesh(brake, points):
    face = Face(
        "PAD_FACE",
        against="DISC_FACE",
        stiffness=2.5e9,
        pressure=5e5,
        mu=0.4,
        points=points,
    )
    at_once = Structure.from_mesh(
        DATA / "brake.mas.gz",
        DATA / "brake.sti.gz",
        mesh=DATA / "brake.inp.gz",
        contacts={"lining": face},
        rotation=Rotation(speed=20, body="DISC_FACE"),
        units="mm-t-s",
    )
    afterwards = brake.with_points(points)
    assert [each.name for each in afterwards.contacts] == [
        each.name for each in at_once.contacts
    ]
    for name in ("normals", "tangentials", "stiffnesses", "preloads", "speeds"):
        np.testing.assert_allclose(
            getattr(afterwards, name), getattr(at_once, name), rtol=1e-12, atol=1e-15
        )
    for one, other in zip(afterwards.contacts, at_once.contacts, strict=True):
        assert one.origin.nodes == other.origin.nodes
    assert brake.with_points(20).contacts == brake.contacts


def test_wrong_numbers_of_points_are_refused(brake):
    with pytest.raises(ValueError, match="points = 0"):
        brake.with_points(0)
