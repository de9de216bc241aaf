"""Onset of squeal: steady sliding loses its stability and a branch of cycles is born."""

import numpy as np
import scipy

from squealpipe.brake.assess.sliding import excess_growth
from squealpipe.brake.cycles.scene import IN_SYSTEM, CycleScene
from squealpipe.brake.cycles.sliding import steady_sliding
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.event_map import EventMap
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.guess import eventless
from squealpipe.systems.cycles.line import ALONG, BRANCH_STEPS
from squealpipe.systems.cycles.solution import Cycle

_SCAN = 201
_FIRST_AMPLITUDE = 0.02
"""Of the first cycle, over the distance of the equilibrium from contact loss."""


def find_onset(
    scene: CycleScene, begin: float, to: float
) -> tuple[ContinuationState, Cycle] | None:
    """A small cycle on the branch born at the first Hopf point from ``begin`` towards ``to``.

    The values are in the scene's units; the tangent points to larger amplitude. None where steady
    sliding keeps its stability, or loses it by divergence.
    """
    flow = Flow(scene.system)

    def growth(value: float) -> float:
        found = steady_sliding(scene.at(value), flow)
        return np.nan if found is None else excess_growth(found.jacobian)

    grid = np.linspace(begin, to, _SCAN)
    rates = np.array([growth(float(value)) for value in grid])
    crossing = np.flatnonzero((rates[:-1] < 0.0) & (rates[1:] > 0.0))
    if not len(crossing):
        return None
    low, high = grid[crossing[0]], grid[crossing[0] + 1]
    onset = float(
        scipy.optimize.brentq(
            growth, low, high, xtol=1e-14 * max(abs(begin), abs(to)), rtol=1e-14
        )
    )
    found = steady_sliding(scene.at(onset), flow)
    if found is None:
        return None
    rest, regime, values = found.state, found.regime, scene.at(onset).values
    roots, vectors = np.linalg.eig(found.jacobian)
    mode = int(np.argmax(roots.real + (roots.imag > 0.0)))
    omega = float(roots[mode].imag)
    if omega <= 0.0:
        return None
    shape = np.real(vectors[:, mode] / np.abs(vectors[:2, mode]).max())
    room = 1.0 - rest[1]
    size = np.array([1.0, 1.0, omega, omega]) * room
    state = rest + _FIRST_AMPLITUDE * room * shape
    name, period = IN_SYSTEM[str(scene.follow)], 2.0 * np.pi / omega
    followed = np.array([values[name]])
    units = np.maximum(np.abs(followed), 1e-3)
    equations = EventMap(Flow(scene.system, (name,)), (), values, size, period, units)
    equations, guess = eventless(equations, state, regime, period, followed)
    # the cycle of that amplitude: its parameter is an unknown
    direction = np.concatenate([shape / size, np.zeros(2)])
    normal = direction / np.linalg.norm(direction)
    first = ALONG.solve(equations, guess, normal, BRANCH_STEPS.first_step)
    return None if first is None else (first, Cycle.at(equations, first.point))
