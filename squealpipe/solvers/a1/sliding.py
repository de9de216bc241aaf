"""Steady sliding of A1 in contact, and small motions about it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from squealpipe.codes import Regime
from squealpipe.models.a1_automaton import A1Automaton

_BALANCE = 1e-8
"""Largest force left over at an equilibrium, over the preload's."""
_COMPLEX_STEP = 1e-30


def sliding_regime(a1: A1Automaton) -> Regime:
    """The regime of a mass at rest that the belt drags along."""
    return Regime.slip_slower if a1.params.belt_speed > 0.0 else Regime.slip_faster


def sliding_equilibrium(a1: A1Automaton) -> NDArray[np.float64] | None:
    """The state of steady sliding in contact, (4,), m and m/s; None where Newton finds none.

    Of several it is the one that a Newton method from r = 0 leads to.
    """
    p, field = a1.params, a1.field(sliding_regime(a1))
    # from r = 0 the solver's steps and differences are absolute numbers, so both are scaled
    force = 0.5 * (p.k1 + p.k2) * p.preload

    def pull(place: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y = p.preload * place
        return np.array(field(0.0, np.array([x, y, 0.0, 0.0])))[2:] * (p.mass / force)

    found = root(pull, [0.0, 0.0], tol=1e-13)
    unbalanced = float(np.abs(pull(found.x)).max()) * force / (p.k3 * p.preload)
    if not unbalanced < _BALANCE or found.x[1] >= 1.0:
        return None
    return np.array([*(p.preload * found.x), 0.0, 0.0])


def sliding_jacobian(a1: A1Automaton, state: Any) -> NDArray[np.float64]:
    """∂f/∂z of steady sliding at a state, (4, 4), by complex steps, exact to round-off."""
    field = a1.field(sliding_regime(a1))
    scale = _COMPLEX_STEP * a1.params.preload
    columns = [np.array(field(0.0, state + 1j * scale * unit)).imag / scale for unit in np.eye(4)]
    return np.stack(columns, axis=-1)
