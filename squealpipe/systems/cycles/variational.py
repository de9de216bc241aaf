"""Exact derivatives along legs, by states, followed parameters and the time.

Along the legs' Taylor series the variational equations δż = A δz + b are collocated in Gauss's
points of each step, all steps at once: a step is a small part of the distance to the next
singularity, so that order twelve leaves no more than round-off.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from squealpipe.systems.cycles.affine import derivatives as affine_derivatives
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import Path, Vector
from squealpipe.systems.taylor.collocation import transfer
from squealpipe.systems.taylor.series import gauss

_NODES, _WEIGHTS, _UP_TO = gauss(6)


def leg_derivatives(flow: Flow, values: Mapping[str, float], path: Path) -> Vector:
    """Return the derivatives of each leg's end by its start, followed parameters and time: (legs,
    n, n + p).
    """
    if flow.is_affine:
        return _affine(flow, values, path)
    matrices = np.zeros((len(path.regimes), flow.columns, flow.columns))
    matrices[:] = np.eye(flow.columns)
    steps, first = len(path.steps), 0
    # of the variational equations, times a bound of its rate
    longest_step = 1.0
    # pieces of steps that are computed at once
    most_together = 20_000
    # steps up to this number are cut into equally many pieces; of a stiff motion the one that
    # needs most needs twice as many as the others
    most_alike = 1_250
    # of one step
    most_pieces = 64
    while first < steps:
        # a step of a stiff motion needs many pieces; that of most motions needs one
        block = slice(first, min(first + most_alike, steps))
        slopes, lengths = _slopes_along(flow, values, path, block, 1)
        rate = _largest_rate(slopes[:, : flow.size])
        with np.errstate(invalid="ignore"):
            needed = (
                float(np.nanmax(np.abs(lengths) * rate, initial=0.0)) / longest_step
            )
        pieces = 1
        if math.isfinite(needed):
            pieces = max(1, min(math.ceil(needed), most_pieces))
        size = most_together // pieces
        for at in range(first, block.stop, size):
            part = slice(at, min(at + size, block.stop))
            if pieces > 1:
                slopes, lengths = _slopes_along(flow, values, path, part, pieces)
            legs = np.repeat(path.leg[part], pieces)
            largest = min(needed / pieces, 1.0) if math.isfinite(needed) else 1.0
            transfer(slopes, lengths, legs, _UP_TO, _WEIGHTS, matrices, largest)
        first = block.stop
    return matrices[:, : flow.size]


def _largest_rate(slopes: Vector) -> Vector:
    """Return a bound of the rate of the variational equations in each piece, from its middle."""
    middle = np.abs(slopes[:, :, len(_NODES) // 2]).transpose(2, 0, 1)
    power = np.linalg.matrix_power(middle, 4).sum(axis=2).max(axis=1)
    return np.asarray(power**0.25)


def _affine(flow: Flow, values: Mapping[str, float], path: Path) -> Vector:
    """Return the derivatives where all rates are affine in the states."""
    first = np.searchsorted(path.leg, np.arange(len(path.regimes)))
    starts = path.series[first, : flow.size, 0]
    followed = np.array([values[name] for name in flow.followed])
    units = np.where(followed == 0.0, 1.0, np.abs(followed))
    matrices = np.empty((len(starts), flow.size, flow.columns))
    for leg, regime in enumerate(path.regimes.tolist()):
        matrices[leg] = affine_derivatives(
            flow.affine_at(values, regime),
            flow.sizes(values),
            units,
            starts[leg],
            float(path.durations[leg]),
        )
    return matrices


def _slopes_along(
    flow: Flow, values: Mapping[str, float], path: Path, which: slice, pieces: int
) -> tuple[Vector, Vector]:
    """Return ∂f/∂(states, parameters, time) at the nodes of pieces of steps, and their lengths.

    (states, columns, nodes, pieces)
    """
    scaled, leg, lengths = path.scaled[which], path.leg[which], path.steps[which]
    count, steps = len(_NODES), len(lengths)
    nodes = (np.arange(pieces) + _NODES[:, None]).ravel() / pieces
    variables = len(flow.system.traced.variables)
    powers = nodes ** np.arange(scaled.shape[2])[:, None]
    states = (scaled[:, :variables] @ powers).reshape(steps, variables, count, pieces)
    flat = states.transpose(1, 2, 0, 3).reshape(variables, count, -1)
    with np.errstate(all="ignore"):
        slopes = flow.slopes_along(values, np.repeat(path.regimes[leg], pieces), flat)
    return slopes, np.repeat(lengths, pieces) * path.unit / pieces
