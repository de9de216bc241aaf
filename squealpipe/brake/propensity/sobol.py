"""Shares, Sobol indices and their intervals from scramblings of a quasi-random sequence.

The points of one scrambled sequence are evener than independent ones, so their own spread, or
resampling them, makes intervals several times too wide. Independent scramblings are independent
estimates, whose spread is the error (Owen's randomized quasi-Monte Carlo).
"""

from dataclasses import dataclass

import numpy as np
import scipy

from squealpipe.vibration.shares import CONFIDENCE, wilson_interval


@dataclass(frozen=True)
class SobolRules:
    """Numbers of replicates and events behind shares and indices."""

    replicates: int = 8
    """Independent scramblings: few cost evenness little, and Student's t still has 7 degrees."""
    least_events: int = 30
    """With fewer cases, or fewer non-cases, in the sample no index is given."""


SOBOL = SobolRules()


def scrambled(inputs: int, size: int, seed: int) -> np.ndarray:
    """Points in the open unit cube, (size, inputs); equal parts are independent scramblings."""
    points = np.concatenate(
        [
            scipy.stats.qmc.Sobol(inputs, rng=rng).random(size // SOBOL.replicates)
            for rng in np.random.default_rng(seed).spawn(SOBOL.replicates)
        ]
    )
    return np.asarray(np.clip(points, 1e-12, 1.0 - 1e-12))


def share_interval(happens: np.ndarray) -> tuple[float, float]:
    """95 % interval of the share of True, at :func:`scrambled` points.

    Student's t over the replicates, not finer than half a point of one of them; of rare cases,
    which gain nothing by evenness, and of nearly certain ones Wilson's.
    """
    count, size = int(happens.sum()), happens.size
    if min(count, size - count) < SOBOL.least_events:
        return wilson_interval(count, size)
    shares = happens.reshape(SOBOL.replicates, -1).mean(axis=1)
    half = max(float(_half_width(shares)), 0.5 * SOBOL.replicates / size)
    return max(0.0, count / size - half), min(1.0, count / size + half)


def _half_width(replicates: np.ndarray) -> np.ndarray:
    """Return the half-width of the mean's interval over the last axis, by Student's t."""
    number = replicates.shape[-1]
    error = replicates.std(axis=-1, ddof=1) / np.sqrt(number)
    return np.asarray(scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, number - 1) * error)


def saltelli_matrices(inputs: int, size: int, seed: int) -> np.ndarray:
    """Points A, B and A with one input of B each, (2 + inputs, inputs, size), in the unit cube.

    Args:
        size: of each matrix, a power of 2; equal parts follow one another, one a scrambling.
    """
    first, second = np.split(scrambled(2 * inputs, size, seed).T, 2)
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
    parts = np.array(
        [
            [(second * (each - first)).mean(axis=-1) for each in mixed],
            [0.5 * ((first - each) ** 2).mean(axis=-1) for each in mixed],
        ]
    )
    indices = parts.mean(axis=-1) / variance.mean()
    # an index is a ratio of means: its error to first order is that of this mean
    off = (parts - indices[..., None] * variance) / variance.mean()
    return indices, _half_width(off)
