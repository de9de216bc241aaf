"""Motion of an undamped linear system from rest under a constant load, by an exact recurrence.

r̈ = b − A r with r(0) = ṙ(0) = 0 has r(t) = (I − cos(√A t)) A⁻¹ b, so samples at equal steps obey
r(t + h) = 2 cos(√A h) r(t) − r(t − h) + 2 (I − cos(√A h)) A⁻¹ b. Both matrices are entire functions
of A: no eigenvalues are needed, and singular, defective and unstable matrices are not an exception.
"""

from collections.abc import Iterator

import numpy as np


def response_from_rest(
    matrix: np.ndarray, load: np.ndarray, step: float, steps: int
) -> Iterator[np.ndarray]:
    """Samples of r at t = 0, h, 2h and so on.

    Args:
        step: h, s, at most ½/√‖A‖.
    """
    cosine, half_push = _series(matrix * (step * step), step)
    push = 2.0 * np.einsum("...ij,...j->...i", half_push, load)
    # components first: long loops over the systems, not over two components
    push = np.moveaxis(push, -1, 0).copy()
    twice = np.moveaxis(2.0 * cosine, (-2, -1), (0, 1)).copy()
    earlier = np.zeros(push.shape)
    now = 0.5 * push
    yield np.moveaxis(earlier, 0, -1)
    for _ in range(steps):
        yield np.moveaxis(now, 0, -1)
        moved = twice[:, 0] * now[0]
        for component in range(1, len(now)):
            moved += twice[:, component] * now[component]
        moved -= earlier
        moved += push
        earlier, now = now, moved


def _series(scaled: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """cos(√A h) and (I − cos(√A h)) A⁻¹ from their power series in A h²."""
    identity = np.broadcast_to(np.eye(scaled.shape[-1]), scaled.shape)
    cosine, push, power, factor = identity.copy(), np.zeros(scaled.shape), identity, 1.0
    # fourteen terms: the rest of the series is under round-off where h √‖A‖ is at most ½
    for term in range(1, 14):
        factor /= -(2 * term - 1) * (2 * term)
        push = push - factor * power
        power = power @ scaled
        cosine = cosine + factor * power
    return cosine, step * step * push
