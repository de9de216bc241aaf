"""The elastic pad in CalculiX: the same block by another program's elements and eigensolver.

Its frequencies with closed contacts and without friction stand beside ours, and complex modes are
computed from the matrices that it writes. Complex frequencies by its own contacts are not compared:
node-to-surface contacts that slid with friction in a static step of this deck had real frequencies
alone in the frequency step after it, those of a block held along the belt.
"""

import shutil
import subprocess

import numpy as np
import pytest
import scipy.linalg as la

from squealpipe import Structure
from squealpipe.structures import elastic_pad

ALONG, ACROSS = 24, 6
FEET = (0, 8, 16, 24)
RECORDED = [
    2561.835,
    9211.504,
    9996.133,
    12878.30,
    15656.46,
    19668.66,
    26020.52,
    30674.66,
    34255.66,
    41557.12,
    41825.71,
    44460.43,
]
"""Frequencies that CalculiX 2.20 printed for this deck, Hz."""


def number(column, row, layer):
    """Number of a node."""
    return 1 + column + (ALONG + 1) * (row + (ACROSS + 1) * layer)


def deck(step, contacts):
    """One layer of C3D8 elements, both faces tied and held: plane strain."""
    lines = ["*NODE, NSET=ALL"]
    nodes = [
        (i, j, k) for k in (0, 1) for j in range(ACROSS + 1) for i in range(ALONG + 1)
    ]
    for i, j, k in nodes:
        x, y, z = 0.06 * i / ALONG, 0.015 * j / ACROSS, 0.05 * k
        lines.append(f"{number(i, j, k)}, {x:.12e}, {y:.12e}, {z:.12e}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=PAD")
    for element in range(ALONG * ACROSS):
        i, j = element % ALONG, element // ALONG
        corners = [
            number(i + right, j + up, k)
            for k in (0, 1)
            for right, up in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
        lines.append(", ".join(map(str, [element + 1, *corners])))
    lines += ["*MATERIAL, NAME=LINING", "*ELASTIC", "8e9, 0.25", "*DENSITY", "2500."]
    lines.append("*SOLID SECTION, ELSET=PAD, MATERIAL=LINING")
    springs = {}
    for direction, stiffness in ((1, 3e7), (2, 5e7)):
        for i in range(ALONG + 1):
            share = (0.5 if i in (0, ALONG) else 1.0) / ALONG
            springs.setdefault((direction, stiffness * share), []).append(
                number(i, ACROSS, 0)
            )
    if contacts:
        springs[2, 2e8] = [number(i, 0, 0) for i in FEET]
    element = ALONG * ACROSS
    for place, ((direction, stiffness), at) in enumerate(springs.items()):
        lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=S{place}")
        lines += [f"{element + n}, {node}" for n, node in enumerate(at, 1)]
        lines += [f"*SPRING, ELSET=S{place}", str(direction), f"{stiffness:.12e}"]
        element += len(at)
    lines.append("*EQUATION")
    for i, j, k in nodes:
        if k == 0:
            for direction in (1, 2):
                back, front = number(i, j, 1), number(i, j, 0)
                lines += ["2", f"{back}, {direction}, 1., {front}, {direction}, -1."]
    lines += ["*BOUNDARY", "ALL, 3, 3", "*STEP", *step, "*END STEP", ""]
    return "\n".join(lines)


def test_frequencies_at_rest_are_those_that_calculix_printed():
    modes = elastic_pad().complex_modes(mu=0.0, n_modes=12)
    assert modes.frequency.values == pytest.approx(RECORDED, rel=3e-7)


def calculix(folder, name, text):
    program = shutil.which("ccx")
    if program is None:
        pytest.skip("CalculiX is not installed (Debian: calculix-ccx)")
    (folder / f"{name}.inp").write_text(text)
    subprocess.run(
        [program, "-i", name], cwd=folder, check=True, capture_output=True, timeout=60
    )


@pytest.mark.release
def test_calculix_prints_these_frequencies(tmp_path):
    calculix(tmp_path, "pad", deck(["*FREQUENCY", "12"], contacts=True))
    rows = [line.split() for line in (tmp_path / "pad.dat").read_text().splitlines()]
    printed = [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]
    assert printed == pytest.approx(RECORDED, rel=1e-6)


@pytest.mark.release
def test_complex_modes_of_matrices_that_calculix_writes_are_the_pads(tmp_path):
    step = ["*FREQUENCY, SOLVER=MATRIXSTORAGE"]
    calculix(tmp_path, "pad", deck(step, contacts=False))
    table = ["name,normal,tangential,stiffness,preload"]
    table += [
        f"p{n},{number(i, 0, 0)}.2:1,{number(i, 0, 0)}.1:1,2e8,200"
        for n, i in enumerate(FEET, 1)
    ]
    (tmp_path / "contacts.csv").write_text("\n".join(table) + "\n")
    (tmp_path / "pad.yaml").write_text(
        "mass: pad.mas\nstiffness: pad.sti\ncontacts: contacts.csv\n"
    )
    pad = Structure.read(tmp_path / "pad.yaml")
    assert pad.size == 350
    for mu in (0.3, 0.5):
        theirs, ours = (
            each.complex_modes(mu=mu, frequency_max=60e3)
            for each in (pad, elastic_pad())
        )
        assert theirs.frequency.values == pytest.approx(ours.frequency.values, rel=1e-9)
        unstable = ours.unstable.values
        assert np.array_equal(theirs.unstable.values, unstable)
        assert theirs.growth_rate.values[unstable] == pytest.approx(
            ours.growth_rate.values[unstable], rel=1e-6
        )


def block_deck():
    """A block of 4 × 3 × 3 C3D8 elements on springs: 240 degrees of freedom."""
    nodes = [(i, j, k) for k in range(4) for j in range(4) for i in range(5)]
    number_of = {node: place for place, node in enumerate(nodes, 1)}
    lines = ["*NODE"]
    lines += [
        f"{number_of[i, j, k]}, {0.02 * i:.9f}, {0.05 * j / 3:.9f}, {0.005 * k:.9f}"
        for i, j, k in nodes
    ]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=PAD")
    cells = [(i, j, k) for k in range(3) for j in range(3) for i in range(4)]
    for element, (i, j, k) in enumerate(cells, 1):
        corners = [
            number_of[i + right, j + ahead, k + up]
            for up in (0, 1)
            for right, ahead in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
        lines.append(", ".join(map(str, [element, *corners])))
    lines += ["*MATERIAL, NAME=LINING", "*ELASTIC", "8e9, 0.25", "*DENSITY", "2500."]
    lines.append("*SOLID SECTION, ELSET=PAD, MATERIAL=LINING")
    back, element = [number_of[node] for node in nodes if node[2] == 3], len(cells)
    for direction, stiffness in ((1, 3e7), (2, 3e7), (3, 5e7)):
        lines.append(f"*ELEMENT, TYPE=SPRING1, ELSET=S{direction}")
        lines += [f"{element + n}, {node}" for n, node in enumerate(back, 1)]
        lines += [f"*SPRING, ELSET=S{direction}", str(direction)]
        lines.append(f"{stiffness / len(back):.12e}")
        element += len(back)
    lines += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP", ""]
    feet = [number_of[i, j, 0] for j in (0, 3) for i in (0, 4)]
    return "\n".join(lines), feet


@pytest.mark.release
def test_a_pad_that_squeals_is_not_quiet_in_24_modes(tmp_path):
    """24 modes have no growing mode, the whole has 14: quiet was told, exit code 0."""
    text, feet = block_deck()
    calculix(tmp_path, "pad", text)
    (tmp_path / "contacts.csv").write_text(
        "name,normal,tangential,stiffness,preload\n"
        + "".join(f"p{n},{n}.3:-1,{n}.1:1,2e8,200\n" for n in feet)
    )
    (tmp_path / "pad.yaml").write_text(
        "mass: pad.mas\nstiffness: pad.sti\ncontacts: contacts.csv\nmu: 0.8\n"
        "modal_damping: 0.003\n"
    )
    pad = Structure.read(tmp_path / "pad.yaml")
    assert pad.size == 240
    # all contacts stay closed: own eigenvalues with the damping of each mode at rest
    mass = pad.mass.toarray()
    springs = pad.stiffness.toarray() + (pad.normals * pad.stiffnesses) @ pad.normals.T
    squares, modes = la.eigh(springs, mass)
    damping = np.diag(2 * 0.003 * np.sqrt(squares))
    friction = 0.8 * (pad.tangentials * pad.stiffnesses) @ pad.normals.T
    sliding = np.diag(squares) + modes.T @ friction @ modes
    values = la.eigvals(
        np.block([[np.zeros_like(damping), np.eye(240)], [-sliding, -damping]])
    )
    grows = values[(values.imag > 0) & (values.real > 1.0)]
    for number in (8, 24, 32):
        record = pad.reduce(n_modes=number).record
        assert record["unstable"] == len(grows) > 0
        assert not record["agrees"]
        assert len(record["missing"])
