"""Sobol indices and their intervals from independent scramblings of a quasi-random sequence.

The points of one scrambled sequence are evener than independent ones, so their own spread, or
resampling them, makes intervals several times too wide. Independent scramblings are independent
estimates, whose spread is the error (Owen's randomized quasi-Monte Carlo).
"""

from __future__ import annotations

import numpy as np
from scipy import stats

REPLICATES = 8
"""Independent scramblings: few cost evenness little, and Student's t still has 7 degrees."""


def saltelli_matrices(inputs: int, size: int, seed: int) -> np.ndarray:
    """Points A, B and A with one input of B each, (2 + inputs, inputs, size), in the unit cube.

    Args:
        inputs: number of inputs.
        size: of each matrix, a power of 2; equal parts follow one another, one a scrambling.
        seed: of the scramblings.
    """
    points = np.concatenate([
        stats.qmc.Sobol(2 * inputs, rng=rng).random(size // REPLICATES)
        for rng in np.random.default_rng(seed).spawn(REPLICATES)
    ]).T  # fmt: skip
    first, second = np.split(np.clip(points, 1e-12, 1.0 - 1e-12), 2)
    matrices = np.stack([first, second, *[first] * inputs])
    for i in range(inputs):
        matrices[2 + i, i] = second[i]
    return matrices


def sobol_indices(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First-order (Saltelli 2010) and total (Jansen) indices with 95 % half-widths.

    Args:
        values: at :func:`saltelli_matrices`, (2 + inputs, replicates, points of one).

    Returns:
        Indices and half-widths (Student's t over the replicates), each (order, inputs).
    """
    first, second, *mixed = values - values[:2].mean()
    variance = 0.5 * (first**2 + second**2).mean(axis=-1)
    parts = np.array([
        [(second * (each - first)).mean(axis=-1) for each in mixed],
        [0.5 * ((first - each) ** 2).mean(axis=-1) for each in mixed],
    ])  # fmt: skip
    indices = parts.mean(axis=-1) / variance.mean()
    # an index is a ratio of means: its error to first order is that of this mean
    off = (parts - indices[..., None] * variance) / variance.mean()
    replicates = len(variance)
    error = off.std(axis=-1, ddof=1) / np.sqrt(replicates)
    return indices, stats.t.ppf(0.975, replicates - 1) * error
