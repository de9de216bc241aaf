"""A disc brake of finite elements: a turning disc, a lining on a back plate, and springs behind it.

The mesh is coarse on purpose, 1,536 degrees of freedom, so that an answer takes seconds; CalculiX
assembles the same matrices from the deck that :func:`deck` writes.
"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import scipy.sparse as sp

from squealpipe.structures.meshes.faces import Face, Rotation
from squealpipe.structures.multilinear_elements import mass_and_stiffness
from squealpipe.structures.structure import Structure
from squealpipe.validation import Natural, NotNegative, Number, Positive, checked

DISC_UNITS = {
    "stiffness": "N m-1",
    "pressure": "Pa",
    "mu": "1",
    "speed": "rad s-1",
    "modal_damping": "1",
}
"""CF units of the brake's numbers."""


@dataclass(frozen=True)
class Body:
    """One body of the brake: modulus (MPa), Poisson's ratio and density (t/mm³) of its material."""

    name: str
    material: str
    young: float
    poisson: float
    density: float


BODIES = (
    Body("DISC", "IRON", 110000.0, 0.28, 7.1e-9),
    Body("LINING", "FRICTION", 4000.0, 0.3, 2.5e-9),
    Body("PLATE", "STEEL", 210000.0, 0.3, 7.85e-9),
)
SPRINGS = (30000.0, 30000.0, 2000.0)
"""Stiffness along x, y and z of the springs at each corner of the back plate, N/mm."""


@dataclass(frozen=True)
class BrakeMesh:
    """Mesh of the brake, mm.

    Attributes:
        nodes: number → position; of the disc from 1 on, of the pad from 5001.
        elements: name of a body → {number: eight nodes}.
        faces: name of a surface → pairs of an element and its side, from 0.
        corners: nodes of the back plate that hang on springs.
        fixed: nodes at the inner radius of the disc, which do not move.
    """

    nodes: dict[int, tuple[float, ...]]
    elements: dict[str, dict[int, list[int]]]
    faces: dict[str, list[tuple[int, int]]]
    corners: list[int]
    fixed: list[int]

    def back(self) -> list[int]:
        """Return the nodes of the plate's back, where a shim lies."""
        top = max(z for *_, z in self.nodes.values())
        return [n for n, (*_, z) in self.nodes.items() if z == top]


def brake_mesh() -> BrakeMesh:
    """Return the mesh: radii 60 to 120 mm, the pad over 40° of the outer three quarters."""
    radii, angles = np.linspace(60.0, 120.0, 5), np.arange(36) * (2.0 * np.pi / 36)
    nodes: dict[int, tuple[float, ...]] = {}

    def layers(
        first: int, heights: list[float], turns: int, rings: range
    ) -> np.ndarray:
        """Add nodes of a grid, and return their numbers, (heights, turns, rings)."""
        shape = len(heights), turns, len(rings)
        numbers = first + np.arange(np.prod(shape)).reshape(shape)
        for k, j, i in np.ndindex(*shape):
            r, angle = radii[rings[i]], angles[j]
            position = (r * np.cos(angle), r * np.sin(angle), heights[k])
            # as the deck has them
            nodes[int(numbers[k, j, i])] = tuple(float(f"{x:.12g}") for x in position)
        return numbers

    disc = layers(1, [-10.0, -5.0, 0.0], 36, range(5))
    pad = layers(5001, [0.0, 5.0, 10.0, 15.0], 5, range(1, 5))
    elements: dict[str, dict[int, list[int]]] = {body.name: {} for body in BODIES}
    faces: dict[str, list[tuple[int, int]]] = {"DISC_FACE": [], "PAD_FACE": []}

    def brick(body: str, grid: np.ndarray, k: int, j: int, i: int) -> int:
        """Add an element between layers k and k + 1, and return its number."""
        number = 10000 * [body.name for body in BODIES].index(body)
        number += len(elements[body]) + 1
        after = (j + 1) % grid.shape[1]
        ring = ((j, i), (j, i + 1), (after, i + 1), (after, i))
        elements[body][number] = [
            int(grid[h, a, b]) for h in (k, k + 1) for a, b in ring
        ]
        return number

    for k, j, i in np.ndindex(2, 36, 4):
        number = brick("DISC", disc, k, j, i)
        if k == 1:
            faces["DISC_FACE"].append((number, 1))
    for k, j, i in np.ndindex(3, 4, 3):
        number = brick("LINING" if k < 2 else "PLATE", pad, k, j, i)
        if k == 0:
            faces["PAD_FACE"].append((number, 0))
    corners = [int(pad[3, j, i]) for i in (0, 3) for j in (0, 4)]
    return BrakeMesh(nodes, elements, faces, corners, disc[:, :, 0].T.ravel().tolist())


@partial(checked, units=DISC_UNITS)
def disc_brake(
    *,
    stiffness: Positive = 2.5e9,
    pressure: Positive = 0.5e6,
    mu: NotNegative = 0.4,
    speed: Number = 20.0,
    modal_damping: NotNegative = 0.0,
    points: Natural | None = None,
) -> Structure:
    """A disc of iron, fixed at its inner radius, and a lining on a steel plate pressed on it.

    Trilinear hexahedra (2 × 2 × 2 points, consistent mass), 1,536 degrees of freedom. The back
    plate hangs on springs at its four corners. The 20 contacts ``lining_1``… are those of the face
    ``lining``, one at each node of the lining above a node of the disc. ``BACK`` is the back of the
    plate, where a shim lies.

    Args:
        stiffness: of the contact over the whole face, N/m.
        pressure: on the lining, Pa.
        mu: friction of the lining.
        speed: of the disc, rad/s, by the right-hand rule about z; the lining is above it.
        modal_damping: as of :class:`Structure`.
        points: number of contacts to which neighbours are merged; None: all 20.

    Raises:
        ValueError: an argument.
    """
    mesh = brake_mesh()
    mass, springs, names = brake_matrices(mesh)
    face = Face(
        "PAD_FACE",
        "DISC_FACE",
        stiffness=stiffness,
        pressure=pressure,
        mu=mu,
        points=points,
    )
    with TemporaryDirectory() as folder:
        path = Path(folder) / "brake.inp"
        path.write_text(deck(mesh), encoding="utf-8")
        return Structure.from_mesh(
            mass,
            springs,
            mesh=path,
            contacts={"lining": face},
            rotation=Rotation((0, 0, 1), (0, 0, 0), speed, "DISC_FACE"),
            degrees_of_freedom=names,
            units="mm-t-s",
            modal_damping=modal_damping,
        )


def brake_matrices(mesh: BrakeMesh) -> tuple[sp.csr_array, sp.csr_array, list[str]]:
    """Return mass (t), stiffness (N/mm) and names ``node.direction`` of what can move."""
    place = {number: index for index, number in enumerate(mesh.nodes)}
    nodes = np.array([*mesh.nodes.values()])
    mass, stiffness = (sp.csr_array((nodes.size, nodes.size)) for _ in range(2))
    for body in BODIES:
        rows = mesh.elements[body.name].values()
        parts = mass_and_stiffness(
            nodes,
            np.array([[place[node] for node in row] for row in rows]),
            young=body.young,
            poisson=body.poisson,
            density=body.density,
        )
        mass, stiffness = mass + parts[0], stiffness + parts[1]
    springs = np.zeros(nodes.shape)
    springs[[place[node] for node in mesh.corners]] = SPRINGS
    stiffness = stiffness + sp.diags_array(springs.ravel())
    free = [n for n in mesh.nodes if n not in set(mesh.fixed)]
    kept = np.concatenate([3 * place[n] + np.arange(3) for n in free])
    names = [f"{n}.{direction}" for n in free for direction in (1, 2, 3)]
    mass, stiffness = (sp.csr_array(each)[kept][:, kept] for each in (mass, stiffness))
    return mass, stiffness, names


def deck(mesh: BrakeMesh) -> str:
    """Return the mesh as an input deck of CalculiX that writes the matrices, mm, t, s."""
    lines = ["*NODE, NSET=NALL"]
    lines += [
        f"{n}, " + ", ".join(f"{x:.12g}" for x in at) for n, at in mesh.nodes.items()
    ]
    for name, rows in mesh.elements.items():
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        lines += [f"{n}, " + ", ".join(map(str, row)) for n, row in rows.items()]
    for name, sides in mesh.faces.items():
        lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        lines += [f"{n}, S{side + 1}" for n, side in sides]
    lines += ["*NSET, NSET=BACK", *map(str, mesh.back())]
    for body in BODIES:
        lines += [
            f"*MATERIAL, NAME={body.material}",
            "*ELASTIC",
            f"{body.young!r}, {body.poisson!r}",
            "*DENSITY",
            f"{body.density!r}",
            f"*SOLID SECTION, ELSET={body.name}, MATERIAL={body.material}",
        ]
    for direction, spring in enumerate(SPRINGS, 1):
        lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=S{direction}")
        lines += [
            f"{30000 + 100 * direction + index}, {node}"
            for index, node in enumerate(mesh.corners)
        ]
        lines += [f"*SPRING, ELSET=S{direction}", f"{direction}", f"{spring!r}"]
    lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in mesh.fixed)]
    lines += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP"]
    return "\n".join(lines) + "\n"
