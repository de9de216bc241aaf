"""Forces and moments of all contacts of a face are the integrals of pressure and friction."""

import numpy as np
import pytest

from squealpipe import Face, Rotation, Structure
from squealpipe.structures.meshes.face_entries import read_pressures
from squealpipe.structures.units import scales_of

PRESSURE = 7e5
DIRECTION = np.array([0.8, 0.6, 0.0])


def plane_mesh(kind, seed=3):
    """A distorted patch of 0.3 × 0.2 m at z = 0.1 seen from below, and its polygon's moments."""
    draw = np.random.default_rng(seed)
    along, across = 5, 4
    x, y = np.meshgrid(np.linspace(0, 0.3, along), np.linspace(0, 0.2, across))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 0.1)])
    inner = (x > 0) & (x < 0.3) & (y > 0) & (y < 0.2)
    points[inner.ravel(), :2] += draw.uniform(-0.02, 0.02, (inner.sum(), 2))
    nodes = [tuple(point) for point in points]
    middles = {}

    def middle(one, other):
        key = frozenset((one, other))
        if key not in middles:
            middles[key] = len(nodes)
            nodes.append(tuple(0.5 * (np.array(nodes[one]) + nodes[other])))
        return middles[key]

    facets = []
    for j in range(across - 1):
        for i in range(along - 1):
            a = j * along + i
            corners = [a, a + along, a + along + 1, a + 1]
            split = kind in ("triangle", "triangle6") or (kind == "mixed" and i % 2)
            parts = [corners[:3], [corners[0], *corners[2:]]] if split else [corners]
            for part in parts:
                edges = zip(part, [*part[1:], part[0]], strict=True)
                quadratic = kind in ("triangle6", "quad8")
                facets.append(
                    [*part, *(middle(*edge) for edge in edges)] if quadratic else part
                )
    return np.array(nodes), facets


@pytest.mark.parametrize("points", [None, 1, 3])
@pytest.mark.parametrize("kind", ["triangle", "quad", "mixed", "triangle6", "quad8"])
def test_resultants_on_a_belt_are_those_of_the_whole_rectangle(kind, points):
    nodes, facets = plane_mesh(kind)
    face = Face(
        "foot",
        stiffness=3e8,
        pressure=PRESSURE,
        direction=[*DIRECTION[:2], 5.0],
        points=points,
    )
    size = 3 * len(nodes)
    structure = Structure.from_mesh(
        np.eye(size), np.eye(size), mesh=(nodes, {"foot": facets}), contacts={"f": face}
    )
    assert points is None or len(structure.contacts) == points
    assert structure.stiffnesses.sum() == pytest.approx(3e8, rel=1e-12)
    assert (structure.stiffnesses > 0).all()
    area, center = 0.06, np.array([0.15, 0.1, 0.1])
    for directions, unit in (
        (structure.normals, np.array([0, 0, 1.0])),
        (structure.tangentials, DIRECTION),
    ):
        forces = (directions @ structure.preloads).reshape(-1, 3)
        expected = PRESSURE * area * unit
        np.testing.assert_allclose(
            forces.sum(axis=0), expected, atol=1e-12 * PRESSURE * area
        )
        np.testing.assert_allclose(
            np.cross(nodes, forces).sum(axis=0),
            np.cross(center, expected),
            atol=1e-9 * PRESSURE * area * 0.3,
        )
        # stiffness too: a face that moves as a whole presses as a whole
        moved = directions.T @ np.tile(unit, len(nodes))
        np.testing.assert_allclose(moved, 1.0, rtol=1e-12)


def test_shares_and_moments_hold_against_another_surface():
    nodes, facets = plane_mesh("quad")
    below = nodes.copy()
    everything = np.concatenate([nodes, below])
    other = [[index + len(nodes) for index in facet[::-1]] for facet in facets]
    size = 3 * len(everything)
    structure = Structure.from_mesh(
        np.eye(size),
        np.eye(size),
        mesh=(everything, {"pad": facets, "disc": other}),
        contacts={
            "f": Face(
                "pad", against="disc", stiffness=1.0, force="2 kN", direction=DIRECTION
            )
        },
    )
    forces = (structure.tangentials @ structure.preloads).reshape(2, -1, 3)
    np.testing.assert_allclose(forces[0], -forces[1], atol=1e-12)
    np.testing.assert_allclose(forces[0].sum(axis=0), 2e3 * DIRECTION, atol=2e-9)


@pytest.mark.parametrize("surface", ["pad", "disc"])
def test_friction_turns_the_pad_with_the_disc_whichever_face_has_the_points(surface):
    nodes, facets = plane_mesh("quad")
    other = [[index + len(nodes) for index in facet[::-1]] for facet in facets]
    against, through = {"pad": "disc", "disc": "pad"}[surface], np.array([0.1, -0.5, 0])
    structure = Structure.from_mesh(
        np.eye(6 * len(nodes)),
        np.eye(6 * len(nodes)),
        mesh=(np.concatenate([nodes, nodes]), {"pad": facets, "disc": other}),
        contacts={"f": Face(surface, against=against, stiffness=1.0, force="2 kN")},
        rotation=Rotation(through=through, speed=20.0, body="Disc"),
    )
    forces = (structure.tangentials @ structure.preloads).reshape(2, -1, 3)
    disc_moves = np.cross([0.0, 0.0, 1.0], nodes - through)
    power = np.einsum("bij,ij->b", forces, disc_moves)
    # every contact's force times its own radius
    total = float(structure.speeds @ structure.preloads)
    assert power == pytest.approx([total, -total], rel=1e-9)


def test_merged_points_keep_first_moments_of_their_forces():
    nodes, facets = plane_mesh("quad", seed=8)
    size = 3 * len(nodes)

    def of(points):
        face = Face(
            "foot", stiffness=1e8, pressure=PRESSURE, direction=[1, 0, 0], points=points
        )
        return Structure.from_mesh(
            np.eye(size),
            np.eye(size),
            mesh=(nodes, {"foot": facets}),
            contacts={"f": face},
        )

    whole = of(None)
    for points in (1, 2, 4, 7, 19, 20):
        merged = of(points)
        assert len(merged.contacts) == points
        np.testing.assert_allclose(
            merged.normals @ merged.preloads, whole.normals @ whole.preloads, rtol=1e-12
        )
        for weights in ("preloads", "stiffnesses"):
            middles = [
                getattr(each, weights)
                @ np.array([contact.origin.position for contact in each.contacts])
                for each in (merged, whole)
            ]
            np.testing.assert_allclose(*middles, rtol=1e-12)
        # neighbours: each group lies in a piece of the face
        assert sum(len(each.origin.nodes) for each in merged.contacts) == len(nodes)


def test_pressure_by_node_presses_each_node_by_its_own(tmp_path):
    nodes, facets = plane_mesh("triangle")
    file = tmp_path / "pressures.csv"
    values = {n: 1e5 * (1 + n % 3) for n in range(1, len(nodes) + 1)}
    file.write_text("\n".join(f"{n}, {value}" for n, value in values.items()))
    size = 3 * len(nodes)
    built = [
        Structure.from_mesh(
            np.eye(size),
            np.eye(size),
            mesh=(nodes, {"foot": facets}),
            contacts={
                "f": Face("foot", stiffness=1e8, pressures=given, direction=[1, 0, 0])
            },
        )
        for given in (values, str(file))
    ]
    for each in built:
        areas = np.array([contact.origin.area for contact in each.contacts])
        np.testing.assert_allclose(each.preloads, areas * list(values.values()))


def test_pressures_of_a_file_are_in_the_units_of_the_structure(tmp_path):
    """MPa with mm, t and s; µN/mm² = Pa with mm, g and s."""
    (tmp_path / "p.txt").write_text("5001 0.5\n5002 2\n")
    for units, pascal in (("mm-t-s", 1e6), ("mm-g-s", 1.0), ("m-kg-ms", 1e6)):
        read = read_pressures(tmp_path / "p.txt", scales_of(units))
        assert read == pytest.approx({5001: 0.5 * pascal, 5002: 2.0 * pascal})
