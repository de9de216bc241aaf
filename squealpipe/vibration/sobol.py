"""Shares, Sobol indices and their intervals from scramblings of a quasi-random sequence.

The points of one scrambled sequence are evener than independent ones, so their own spread, or
resampling them, makes intervals several times too wide. Independent scramblings are independent
estimates, whose spread is the error (Owen's randomized quasi-Monte Carlo).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from squealpipe.vibration.shares import CONFIDENCE, wilson_interval


@dataclass(frozen=True)
class SobolRules:
    """Numbers of replicates and events behind shares and indices."""

    replicates: int = 8
    """Independent scramblings: few cost evenness little, and Student's t still has 7 degrees."""
    least_events: int = 30
    """No index is given of a sample with fewer cases, or fewer non-cases."""
    widest: float = 0.05
    """Half-width of an index's 95 % interval above which it is not given."""


INDEX_ORDERS = ("first_order", "total_order")
INDICES = tuple(
    f"{order}{end}" for order in INDEX_ORDERS for end in ("", "_low", "_high")
)
"""Variables of the indices and of their 95 % intervals."""


def scrambled(inputs: int, size: int, seed: int) -> np.ndarray:
    """Points in the open unit cube, (size, inputs); equal parts are independent scramblings."""
    points = np.concatenate(
        [
            scipy.stats.qmc.Sobol(inputs, rng=rng).random(size // SobolRules.replicates)
            for rng in np.random.default_rng(seed).spawn(SobolRules.replicates)
        ]
    )
    return np.asarray(np.clip(points, 1e-12, 1.0 - 1e-12))


def share_interval(happens: np.ndarray) -> tuple[float, float]:
    """95 % interval of the share of True, at :func:`scrambled` points.

    Student's t over the replicates, not finer than half a point of one of them; of rare cases,
    which gain nothing by evenness, and of nearly certain ones Wilson's.
    """
    count, size = int(happens.sum()), happens.size
    if min(count, size - count) < SobolRules.least_events:
        return wilson_interval(count, size)
    shares = happens.reshape(SobolRules.replicates, -1).mean(axis=1)
    half = max(float(_half_width(shares)), 0.5 * SobolRules.replicates / size)
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


def supported_indices(
    judged: Sequence[np.ndarray], parts: int, widest: float = SobolRules.widest
) -> dict[str, np.ndarray]:
    """Sobol indices with intervals, and the widest total's half-width by sample size.

    Args:
        parts: of the sample, each twice the one before; the last is all of it.
        widest: largest half-width of an index that is given.
    """
    shape = (len(judged), len(judged[0]) - 2)
    indices = {key: np.full(shape, np.nan) for key in INDICES}
    half_widths = np.full((len(judged), parts), np.nan)
    for row, flat in enumerate(judged):
        whole = flat.reshape(len(flat), SobolRules.replicates, -1)
        for column in range(parts):
            part = whole[..., : whole.shape[-1] >> (parts - 1 - column)]
            count = part[0].sum()
            if min(count, part[0].size - count) < SobolRules.least_events:
                continue
            value, half = sobol_indices(part)
            half_widths[row, column] = half[1].max()
            if column < parts - 1:
                continue
            # beyond its interval below 0 an estimate is a failure of the sample, not an index
            failed = (half > widest) | (value + half < 0.0)
            for order, name in enumerate(INDEX_ORDERS):
                for end, limit in (
                    ("", value),
                    ("_low", value - half),
                    ("_high", value + half),
                ):
                    indices[name + end][row] = np.where(
                        failed[order], np.nan, limit[order]
                    )
    return {**indices, "half_width_by_size": half_widths}


def judged_matrices(
    judge: Callable[[np.ndarray], np.ndarray],
    frozen: Mapping[str, Any],
    size: int,
    seed: int,
) -> np.ndarray:
    """Return the judged quantities at Saltelli's samples, (2 + inputs, quantities, size)."""
    return np.stack(
        [
            judge(
                np.array(
                    [
                        each.ppf(u)
                        for each, u in zip(frozen.values(), matrix, strict=True)
                    ]
                )
            )
            for matrix in saltelli_matrices(len(frozen), size, seed)
        ]
    ).astype(float)
