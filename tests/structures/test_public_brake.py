"""BrakeSqueal0.1 at any speed from one file, against own shift-and-invert Arnoldi.

The matrices are too large to ship; SQUEALPIPE_BRAKE_MATRICES names their folder.
"""

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigs, splu

from squealpipe import Structure

FOLDER = Path(
    os.environ.get(
        "SQUEALPIPE_BRAKE_MATRICES",
        Path(__file__).resolve().parents[3] / "shared/data/brake_squeal",
    )
)
BAND = 42000.0  # rad/s
FILE = f"""
triangle: keep
mass: {FOLDER}/BMLL00.mat
stiffness: {FOLDER}/BKLL00.mat
damping: {FOLDER}/BDLL00.mat
belt_speed: 1
speed_terms:
  damping:
    - {{matrix: {FOLDER}/BYLL00.mat, power: 1}}
    - {{matrix: {FOLDER}/BDIWLL00.mat, power: -1}}
    - {{matrix: {FOLDER}/BDIWLL00.mat, power: 0, factor: -1}}
    - {{matrix: {FOLDER}/BHLL00.mat, power: 0, factor: {1 / (3200 * np.pi)!r}}}
  stiffness:
    - {{matrix: {FOLDER}/BKQLL00.mat, power: 0}}
    - {{matrix: {FOLDER}/BWLL00.mat, power: 2}}
    - {{matrix: {FOLDER}/BWLL00.mat, power: 0, factor: -1}}
"""

pytestmark = [
    pytest.mark.skipif(
        not (FOLDER / "BMLL00.mat").is_file(),
        reason="matrices of BrakeSqueal0.1 are not there",
    ),
    pytest.mark.release,
]


def matrices(speed):
    """M, C, K at a speed, rad/s, by the formula of the brake's own code."""

    def load(name):
        content = scipy.io.loadmat(FOLDER / f"{name}.mat", spmatrix=False)
        return sp.csc_array(next(v for key, v in content.items() if key[0] != "_"))

    damping = (
        load("BDLL00") + load("BYLL00") * speed + load("BDIWLL00") * (1 / speed - 1)
    )
    damping = damping + load("BHLL00") / (3200 * np.pi)
    stiffness = load("BKLL00") + load("BKQLL00") + load("BWLL00") * (speed**2 - 1)
    return load("BMLL00"), damping, stiffness


def around(parts, shift, count):
    """Eigenvalues nearest to a shift: Arnoldi with the linear form, then Newton's iteration."""
    mass, damping, stiffness = parts
    size = mass.shape[0]

    def quadratic(value):
        return splu(sp.csc_array(mass * value**2 + damping * value + stiffness))

    factors = quadratic(shift)

    def inverse(pair):
        # (A − σB)⁻¹ B of A = [0 1; −K −C], B = [1 0; 0 M]
        low, high = pair[:size], pair[size:]
        x = -factors.solve(mass @ high + (damping + mass * shift) @ low)
        return np.concatenate([x, low + shift * x])

    operator = LinearOperator((2 * size, 2 * size), inverse, dtype=complex)
    start = np.ones(2 * size, complex)
    inverses, shapes = eigs(operator, count, v0=start, ncv=2 * count + 20, tol=1e-10)
    found = []
    for value, shape in zip(shift + 1 / inverses, shapes[:size].T, strict=True):
        # too far from growing to need its digits, or another one's conjugate
        if value.real < -1 or value.imag < 0:
            continue
        left, right, root = None, shape, value
        for _ in range(2):
            near = quadratic(root * (1 + 1e-9))
            right = near.solve((2 * root * mass + damping) @ right)
            left = near.solve(
                right.conj() if left is None else (2 * root * mass + damping).T @ left,
                trans="T",
            )
            right, left = right / np.linalg.norm(right), left / np.linalg.norm(left)
            q = (
                left @ (mass @ right),
                left @ (damping @ right),
                left @ (stiffness @ right),
            )
            roots = np.roots(q)
            root = roots[np.abs(roots - root).argmin()]
        found.append(root)
    return np.array(found), np.abs(1 / inverses).max()


@pytest.mark.parametrize("speed", [2.0, 8.0, 4 * np.pi, 25.0, 10 * np.pi, 50.0])
def test_the_public_brake_at_any_speed(speed, tmp_path):
    (tmp_path / "brake.yaml").write_text(FILE)
    structure = Structure.read(tmp_path / "brake.yaml")
    modes = structure.complex_modes(
        belt_speed=speed, frequency_max=BAND / (2 * np.pi), critical=False
    )
    ours = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
    ours = np.sort_complex(ours[modes.unstable.values])
    parts, truth, covered = matrices(speed), [], 0.0
    while covered < BAND:
        values, radius = around(parts, 1j * (covered + 4000.0), 60)
        assert radius > 4000.0, "circles about the shifts leave a gap"
        truth.extend(
            v
            for v in values
            if v.real > 1e-6
            and v.imag <= BAND
            and not any(abs(v - k) < 1e-4 for k in truth)
        )
        covered += 4000.0 + np.sqrt(radius**2 - 50.0**2)
    truth = np.sort_complex(np.array(truth))
    assert len(ours) == len(truth)
    assert np.abs(ours.imag / truth.imag - 1).max() < 1e-9
    assert np.abs(ours.real - truth.real).max() < 1e-6
