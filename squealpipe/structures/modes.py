"""Real modes of a structure with closed contacts and without friction, (M, K + Σ kᵢ nᵢnᵢᵀ)."""

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE, LowRank
from squealpipe.structures.stiff import beyond_gap, condensation, stiff_degrees


def modes_at_rest(
    structure: ContactStructure,
    number: int | None = None,
    omega_max: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The lowest modes: ω (k,), rad/s, ascending, and Φ (n, k) with ΦᵀMΦ = 1.

    Args:
        number: how many; None: all, or those up to ``omega_max``.
        omega_max: rad/s.
    """
    size = structure.size
    stiffness = structure.stiffness_at_rest
    if size <= DENSE:
        squares, modes = _all(stiffness.toarray(), structure.mass.toarray())
    else:
        squares, modes = _lowest(stiffness, structure.mass, number, omega_max)
    omega = np.sqrt(np.maximum(squares, 0.0))
    if number is None:
        number = size if omega_max is None else int((omega <= omega_max).sum())
    # the largest part of each shape is positive: the same signs on every machine
    peaks = modes[np.abs(modes).argmax(axis=0), np.arange(modes.shape[1])]
    return omega[:number], (modes * np.sign(peaks))[:, :number]


def highest_frequency(structure: ContactStructure) -> float | None:
    """Return the highest frequency at rest without what a penalty fixes, Hz; None if large."""
    if structure.size > DENSE:
        return None
    omega, _ = modes_at_rest(structure)
    return float(omega[free_degrees(structure) - 1] / (2 * np.pi))


def free_degrees(structure: ContactStructure) -> int:
    """Count the degrees of freedom that no penalty fixes; a run of the others would not end."""
    mass, stiffness = structure.mass, structure.stiffness_at_rest
    if structure.size > DENSE:
        fixed = beyond_gap(mass.diagonal(), stiffness.diagonal())
    else:
        fixed = int(stiff_degrees(mass.toarray(), stiffness.toarray()).sum())
    return structure.size - fixed


def audible_band(structure: ContactStructure) -> float | None:
    """Return the end of hearing, Hz, where modes lie beyond it, as a mesh has many; else None.

    Commands and studies look at modes up to there where no band is asked for; None: all modes, or
    beyond 1000 degrees of freedom not known.
    """
    end_of_hearing = 20e3
    highest = highest_frequency(structure)
    return None if highest is None or highest <= end_of_hearing else end_of_hearing


def modal_damping_of(
    structure: ContactStructure,
    number: int | None = None,
    omega_max: float | None = None,
) -> LowRank | None:
    """M Φ diag(2 ζ ω) Φᵀ M of so many modes, or of those up to a frequency, rad/s, or all."""
    ratios = structure.modal_damping
    if not np.any(ratios):
        return None
    if ratios.ndim:
        number = len(ratios)
    omega, modes = modes_at_rest(structure, number, omega_max)
    ratios = np.broadcast_to(ratios, omega.shape)
    return LowRank(structure.mass @ modes, 2.0 * ratios * omega)


def _all(stiffness: np.ndarray, mass: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ω² and modes, those of stiff degrees of freedom last (:mod:`.stiff`)."""
    stiff = stiff_degrees(mass, stiffness)
    if not stiff.any():
        return la.eigh(stiffness, mass)  # type: ignore[no-any-return]
    basis = condensation(stiffness, stiff)
    squares, modes = la.eigh(basis.T @ stiffness @ basis, basis.T @ mass @ basis)
    # then the stiff ones, whose motion moves the others by inertia
    rest = np.zeros((len(mass), stiff.sum()))
    rest[stiff] = np.eye(stiff.sum())
    rest[~stiff] = -la.solve(mass[np.ix_(~stiff, ~stiff)], mass[np.ix_(~stiff, stiff)])
    high, shapes = la.eigh(rest.T @ stiffness @ rest, rest.T @ mass @ rest)
    return np.concatenate([squares, high]), np.hstack([basis @ modes, rest @ shapes])


def _lowest(
    stiffness: sp.csr_array,
    mass: sp.csr_array,
    number: int | None,
    omega_max: float | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Compute them by Lanczos about a point just below zero, where rigid bodies are no pole."""
    shift = -1e-3 * float((np.abs(stiffness.diagonal()) / mass.diagonal()).min() or 1.0)
    # modes computed at first where it is not known how many there are up to a frequency
    wanted = number or 40
    start = np.random.default_rng(0).standard_normal(mass.shape[0])
    while True:
        wanted = min(wanted, mass.shape[0] - 1)
        squares, modes = eigsh(
            sp.csc_array(stiffness), wanted, sp.csc_array(mass), sigma=shift, v0=start
        )
        order = np.argsort(squares)
        squares, modes = squares[order], modes[:, order]
        if number is not None or squares[-1] > (omega_max or 0.0) ** 2:
            return squares, modes
        if wanted == mass.shape[0] - 1:
            return squares, modes
        wanted *= 2
