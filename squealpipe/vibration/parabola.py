"""Parabolas through three neighbouring samples: where they turn, and how high."""

from typing import Any

import numpy as np


def vertex(before: Any, here: Any, after: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return how many steps the vertex lies after the middle sample, and its value; a line has
    none.
    """
    curvature = before - 2.0 * here + after
    shift = np.where(curvature == 0.0, 0.0, 0.5 * (before - after)) / np.where(
        curvature == 0.0, 1.0, curvature
    )
    return shift, here - 0.25 * (before - after) * shift


def neighbours(samples: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return, of (…, n) samples, the one before each index, that at it, and the one after."""
    places = at[..., None]
    return tuple(
        np.take_along_axis(samples, places + k, axis=-1)[..., 0] for k in (-1, 0, 1)
    )


def largest(samples: np.ndarray) -> np.ndarray:
    """Largest of (…, n) samples, raised to the vertex around it where it lies inside."""
    top = samples.argmax(axis=-1)
    inner = np.clip(top, 1, samples.shape[-1] - 2)
    _, height = vertex(*neighbours(samples, inner))
    return np.asarray(np.where(top == inner, height, samples.max(axis=-1)))
