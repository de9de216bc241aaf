"""Steady sliding of A1 in contact, and small motions about it."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import root

from squealpipe.solvers.a1.jobs import STATE
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.trace import TIME
from squealpipe.tasks.cycles.scene import CycleScene

GROWS = 1e-7
"""Growth rate, over the largest |s|, above which steady sliding is unstable; below it is the
round-off of an undamped pair."""
_BALANCE = 1e-8
"""Largest force left over at an equilibrium, over the preload's."""
_MOST_PIECES = 20
"""Pieces of a law's table that are tried one after the other."""


@dataclass(frozen=True)
class SlidingState:
    """The state of steady sliding in contact, in the scene's units.

    Attributes:
        state: (4,).
        regime: number of the system's regime there.
        jacobian: ∂f/∂z there, (4, 4).
    """

    state: Vector
    regime: int
    jacobian: Vector


def steady_sliding(scene: CycleScene, flow: Flow | None = None) -> SlidingState | None:
    """The equilibrium that a Newton method from r = 0 leads to; None where it finds none."""
    flow, values = flow or Flow(scene.system), scene.values
    force = 0.5 * (scene.scaled.k1 + scene.scaled.k2)
    state, regime = np.zeros(4), _regime(scene, np.zeros(4))
    for _ in range(_MOST_PIECES):

        def pull(place: Vector, regime: int = regime) -> Vector:
            return (
                flow.field(values, regime, np.array([*place, 0.0, 0.0]), 0.0)[2:]
                / force
            )

        found = root(pull, state[:2], tol=1e-13)
        unbalanced = float(np.abs(pull(found.x)).max()) * force / scene.scaled.k3
        if not unbalanced < _BALANCE or found.x[1] >= 1.0:
            return None
        state, before = np.array([*found.x, 0.0, 0.0]), regime
        regime = _regime(scene, state)
        if regime == before:
            return SlidingState(state, regime, flow.jacobian(values, regime, state))
    return None


def _regime(scene: CycleScene, state: Vector) -> int:
    """The regime of the system at a state."""
    given = {name: np.array([value]) for name, value in zip(STATE, state, strict=True)}
    return int(
        scene.system.first_regimes({**scene.values, **given, TIME: np.zeros(1)}, 1)[
            0, 0
        ]
    )
