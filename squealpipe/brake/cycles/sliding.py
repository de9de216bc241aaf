"""Steady sliding of A1 in contact, and small motions about it."""

from dataclasses import dataclass

import numpy as np
import scipy

from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.cycles.scene import CycleScene
from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import Vector
from squealpipe.systems.trace import TIME

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
    """The equilibrium that slowly raised friction leads to from r = 0; None where there is none.

    Where that loses contact it is the one that Newton's method leads to, if any.
    """
    state, rules = np.zeros(4), VARIANT_RULES[scene.model]
    if rules.drags and not rules.linear_springs:
        # springs that turn have several, and Newton's method alone may end on a saddle
        sliding = Sliding.of(Design(scene.params, scene.alpha1, scene.alpha2))
        if sliding is not None:
            state = sliding.state / scene.state_units
    flow, values = flow or Flow(scene.system), scene.values
    force = 0.5 * (scene.scaled.k1 + scene.scaled.k2)
    regime = _regime(scene, state)
    for _ in range(_MOST_PIECES):

        def pull(place: Vector, regime: int = regime) -> Vector:
            return (
                flow.field(values, regime, np.array([*place, 0.0, 0.0]), 0.0)[2:]
                / force
            )

        found = scipy.optimize.root(pull, state[:2], tol=1e-13)
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
