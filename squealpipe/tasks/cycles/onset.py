"""Where steady sliding loses its stability and a branch of cycles is born."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from squealpipe.methods.continuation import ContinuationSettings, ContinuationState
from squealpipe.methods.cycles.cycle_equations import CycleEquations, cycle_algorithm
from squealpipe.methods.cycles.event_flow import Vector
from squealpipe.solvers.a1.flow import A1Flow
from squealpipe.solvers.a1.sliding import sliding_equilibrium, sliding_regime

_SCAN = 201
_FIRST_AMPLITUDE = 0.02
"""Of the first cycle, over the distance of the equilibrium from contact loss."""


def sliding_eigenvalues(
    system: A1Flow, equilibrium: Vector
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Eigenvalues and eigenvectors of small motions about steady sliding."""
    regime = sliding_regime(system.a1)
    jacobian = system.jacobian(regime, equilibrium)
    values, vectors = np.linalg.eig(jacobian)
    return values.astype(np.complex128), vectors.astype(np.complex128)


def find_onset(
    system_at: Callable[[float], A1Flow],
    begin: float,
    to: float,
    unit: float,
    steps: ContinuationSettings,
) -> tuple[CycleEquations, ContinuationState] | None:
    """A small cycle on the branch born at the first Hopf point from ``begin`` towards ``to``.

    Returns:
        The equations around it and a state whose tangent points to larger amplitude, or None where
        steady sliding keeps its stability, or loses it by divergence.
    """

    def growth(value: float) -> float:
        system = system_at(value)
        equilibrium = sliding_equilibrium(system.a1)
        if equilibrium is None:
            return np.nan
        return float(sliding_eigenvalues(system, equilibrium)[0].real.max())

    grid = np.linspace(begin, to, _SCAN)
    rates = np.array([growth(float(value)) for value in grid])
    crossing = np.flatnonzero((rates[:-1] < 0.0) & (rates[1:] > 0.0))
    if not len(crossing):
        return None
    low, high = grid[crossing[0]], grid[crossing[0] + 1]
    onset = float(brentq(growth, low, high, xtol=1e-14 * unit, rtol=1e-14))
    system = system_at(onset)
    equilibrium = sliding_equilibrium(system.a1)
    if equilibrium is None:
        return None
    values, vectors = sliding_eigenvalues(system, equilibrium)
    mode = int(np.argmax(values.real + (values.imag > 0.0)))
    omega = float(values[mode].imag)
    if omega <= 0.0:
        return None
    shape = np.real(vectors[:, mode] / np.abs(vectors[:2, mode]).max())
    room = system.params.preload - equilibrium[1]
    amplitude = _FIRST_AMPLITUDE * room
    size = np.array([1.0, 1.0, omega, omega]) * room
    regime = sliding_regime(system.a1)
    state = equilibrium + amplitude * shape
    velocity = system.velocity(regime, state) / size
    equations = CycleEquations(
        system_at=system_at,
        scale=size,
        time=2.0 * np.pi / omega,
        unit=unit,
        reference=state,
        normal=velocity / np.linalg.norm(velocity),
    )
    direction = np.zeros(6)
    direction[:4] = shape / size
    direction /= np.linalg.norm(direction)
    guess = equations.pack(state, equations.time, onset)
    state = cycle_algorithm(steps).solve(equations, guess, direction, steps.first_step)
    return None if state is None else (equations, state)
