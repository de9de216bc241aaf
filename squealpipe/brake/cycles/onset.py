"""Onset of squeal: steady sliding loses its stability and a branch of cycles is born."""

import numpy as np
import scipy

from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.cycles.cycle import IN_SYSTEM
from squealpipe.systems.continuation import ContinuationState
from squealpipe.systems.cycles.event_map import EventMap
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.guess import eventless
from squealpipe.systems.cycles.line import along_branch, branch_steps
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.trace import TIME


def find_onset(
    design: Design, parameter: str, begin: float, to: float
) -> tuple[ContinuationState, Cycle] | None:
    """A small cycle on the branch born at the first Hopf point from ``begin`` towards ``to``.

    The tangent points to larger amplitude. None where steady sliding keeps its stability, or loses
    it by divergence.

    Args:
        parameter: name of a parameter or angle, whose values are ``begin`` and ``to``.
    """

    def sliding_at(value: float) -> Sliding | None:
        return Sliding.of(design.at(parameter, value))

    def growth(value: float) -> float:
        sliding = sliding_at(value)
        return np.nan if sliding is None else sliding.margin

    scanned = 201
    grid = np.linspace(begin, to, scanned)
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
    sliding = sliding_at(onset)
    if sliding is None:
        return None
    system, name = brake_of(design.params, varied=[parameter]), IN_SYSTEM[parameter]
    there = sliding.design
    values = parameters_of_run(there.params, there.alpha1, there.alpha2)
    flow, inside = Flow.of(system, values, (name,))
    units, second = flow.scale_of(*STATE), float(flow.scale_of(TIME)[0])
    # eigenvectors have a phase that depends on the units: here the flow's
    jacobian = sliding.jacobian * second * units / units[:, None]
    roots, vectors = np.linalg.eig(jacobian)
    mode = int(np.argmax(roots.real + (roots.imag > 0.0)))
    omega = float(roots[mode].imag)
    if omega <= 0.0:
        return None
    shape = np.real(vectors[:, mode] / np.abs(vectors[:2, mode]).max())
    rest = sliding.state / units
    room = 1.0 - rest[1]
    size = np.array([1.0, 1.0, omega, omega]) * room
    # of the first cycle, over the distance of the equilibrium from contact loss
    first_amplitude = 0.02
    state = rest + first_amplitude * room * shape
    at_rest = dict(zip(STATE, sliding.state[:, None], strict=True))
    regime = int(
        system.first_regimes({**values, **at_rest, TIME: np.zeros(1)}, 1)[0, 0]
    )
    period, followed = 2.0 * np.pi / omega, np.array([inside[name]])
    followed_units = np.maximum(np.abs(followed), 1e-3)
    equations = EventMap(flow, (), inside, size, period, followed_units)
    equations, guess = eventless(equations, state, regime, period, followed)
    # the cycle of that amplitude: its parameter is an unknown
    direction = np.concatenate([shape / size, np.zeros(2)])
    normal = direction / np.linalg.norm(direction)
    first = along_branch.solve(equations, guess, normal, branch_steps.first_step)
    return None if first is None else (first, Cycle.at(equations, first.point))
