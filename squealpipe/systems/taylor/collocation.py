"""Derivatives along legs from the variational equations, collocated in each step; compiled.

The rates at the nodes of a step are integrated to states there, which give the rates anew (Picard).
"""

import math
from functools import cache
from typing import Any

import numpy as np

from squealpipe.systems.compiled import part
from squealpipe.systems.taylor.lanes import (
    Workspace,
    address_of,
    compile_advance,
    record_viewer,
    view,
)


@part
def _integrate(rates: Any, up_to: Any, states: Any) -> None:
    """States at the nodes from their rates there; identities at the start of the step."""
    nodes, n, columns, steps = rates.shape
    for node in range(nodes):
        for i in range(n):
            for c in range(columns):
                state = states[node, i, c]
                state[:] = 1.0 if i == c else 0.0
                for other in range(nodes):
                    share, rate = up_to[node, other], rates[other, i, c]
                    for s in range(steps):
                        state[s] += share * rate[s]


@part
def _add_product(slope: Any, states: Any, rates: Any) -> None:
    """Add a slope times a row of states to a row of rates."""
    columns, steps = rates.shape
    for c in range(columns):
        for s in range(steps):
            rates[c, s] += slope[s] * states[c, s]


@part
def _multiply(slopes: Any, lengths: Any, first: int, states: Any, rates: Any) -> None:
    """Rates at the nodes from the states there, over some of the steps."""
    nodes, n, columns, steps = rates.shape
    last = first + steps
    for node in range(nodes):
        for i in range(n):
            for c in range(columns):
                rate = rates[node, i, c]
                for s in range(steps):
                    rate[s] = slopes[i, c, node, first + s] if c >= n else 0.0
            for j in range(n):
                slope = slopes[i, j, node, first:last]
                if slope.any():
                    _add_product(slope, states[node, j], rates[node, i])
            for c in range(columns):
                rate = rates[node, i, c]
                for s in range(steps):
                    rate[s] *= lengths[first + s]


TRANSFER_ARRAYS = (
    "slopes",
    "lengths",
    "leg",
    "up_to",
    "weights",
    "matrices",
    "rates",
    "states",
    "growth",
    "product",
)
TRANSFER_SIZES = ("n", "columns", "nodes", "steps", "legs", "together", "sweeps")
TRANSFER_TABLE = np.dtype(
    [(name, "i8") for name in (*TRANSFER_ARRAYS, *TRANSFER_SIZES)]
)
_record_at: Any = record_viewer(TRANSFER_TABLE)


def transfer(
    slopes: Any,
    lengths: Any,
    leg: Any,
    up_to: Any,
    weights: Any,
    matrices: Any,
    largest: float,
) -> None:
    """Multiply the derivatives of legs by those along steps, by collocation.

    Args:
        slopes: (states, columns, nodes, steps) of the rates by states and parameters.
        lengths, leg: (steps,) length of each step and its leg.
        up_to: (nodes, nodes) integrals of Lagrange's polynomials up to each node.
        weights: (nodes,) of the quadrature.
        matrices: (legs, columns, columns), identities at first; the last rows keep parameters.
        largest: largest product of a step's length and the rate, at most 1.
    """
    n, columns, nodes, steps = slopes.shape
    # 4096 entries at one node are iterated together: six nodes of rates and states fill 400 kB,
    # a processor's second cache; of twice as many, rates wait for the memory
    together = min(max(8, 4096 // (n * columns)), steps)
    # Picard's iterations: where the product is 1, 1/19! is round-off
    sweeps = 1
    while largest**sweeps * math.factorial(19) > math.factorial(sweeps):
        sweeps += 1
    sizes = n, columns, nodes, steps, len(matrices), together, sweeps
    arrays = (
        *map(np.ascontiguousarray, (slopes, lengths, leg, up_to, weights)),
        matrices,
        *np.empty((2, nodes * n * columns * together)),
        *np.empty((2, n * columns)),
    )
    work = Workspace(
        TRANSFER_TABLE,
        dict(zip(TRANSFER_ARRAYS, arrays, strict=True)),
        dict(zip(TRANSFER_SIZES, sizes, strict=True)),
    )
    transfer_steps()(work.pointer)


@part
def _multiply_by_step(
    rates: Any, weights: Any, step: int, growth: Any, product: Any, matrix: Any
) -> None:
    """Multiply a leg's derivatives by those along a step, of which the rates are known."""
    nodes, n, columns, _ = rates.shape
    growth[:] = 0.0
    for node in range(nodes):
        for i in range(n):
            for c in range(columns):
                growth[i, c] += weights[node] * rates[node, i, c, step]
    product[:] = 0.0
    for i in range(n):
        for j in range(columns):
            for c in range(columns):
                product[i, c] += growth[i, j] * matrix[j, c]
    for i in range(n):
        for c in range(columns):
            matrix[i, c] += product[i, c]


def _transfer(table: Any) -> int:
    """Do what :func:`transfer` says; returns 0. The table: ``TRANSFER_TABLE``."""
    t = _record_at(address_of(table))
    n, columns, nodes, steps = t.n, t.columns, t.nodes, t.steps
    slopes = view(t.slopes, (n, columns, nodes, steps), np.float64)
    lengths, leg = (
        view(t.lengths, (steps,), np.float64),
        view(t.leg, (steps,), np.int64),
    )
    up_to = view(t.up_to, (nodes, nodes), np.float64)
    weights = view(t.weights, (nodes,), np.float64)
    matrices = view(t.matrices, (t.legs, columns, columns), np.float64)
    growth = view(t.growth, (n, columns), np.float64)
    product = view(t.product, (n, columns), np.float64)
    for first in range(0, steps, t.together):
        size = min(t.together, steps - first)
        rates = view(t.rates, (nodes, n, columns, size), np.float64)
        states = view(t.states, (nodes, n, columns, size), np.float64)
        rates[:] = 0.0
        for _ in range(t.sweeps):
            _integrate(rates, up_to, states)
            _multiply(slopes, lengths, first, states, rates)
        for s in range(size):
            _multiply_by_step(
                rates, weights, s, growth, product, matrices[leg[first + s]]
            )
    return 0


@cache
def transfer_steps() -> Any:
    """Return the compiled function, loaded once a process."""
    return compile_advance(_transfer)
