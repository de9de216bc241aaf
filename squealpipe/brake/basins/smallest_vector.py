"""The smallest vector for which something happens: random directions, bisection, local search.

Nothing is asked of where it happens but that it can be asked of many vectors at once. Along a ray
the first of some evenly spaced radii at which it happens is found, and the interval below it is
bisected; a region that begins and ends between two of them is overlooked, so each result is an
upper bound. The best directions are then improved by random steps that shrink.

What the directions themselves say of the minimum is order statistics: of n independent ones, with
probability 1 − p at most a share 1 − p^(1/n) of all directions has a smaller radius.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]
Happens = Callable[[Array], NDArray[np.bool_]]
"""(n, size) vectors → whether it happens for each."""

IMPROVED = 4
"""Number of best directions that are improved, and of rounds of random steps."""


@dataclass(frozen=True)
class SearchEffort:
    """Effort of the search for the smallest vector that has an effect.

    More of each finds smaller vectors, at proportional cost.
    """

    radii: int = 16
    """Evenly spaced radii at which each direction is tried."""
    halvings: int = 8
    """Halvings of the interval below the first radius with the effect."""
    first_step: float = 0.5
    """Length of the first random steps on the unit sphere."""
    gain: float = 1e-3
    """A step counts as better where the effect still happens at a radius smaller by this share."""
    shrink: float = 0.5
    """Steps shrink by this factor after a round without a better one."""
    rounds: int = 14
    """Rounds of random steps."""
    tries: int = 16
    """Steps from each of the best directions in a round."""
    followed: int = 3
    """Better steps of these that are bisected."""
    refinement: int = 2
    """Times as many halvings for these as for a direction."""


effort = SearchEffort()


class SearchResult(NamedTuple):
    """Result of a search; ∞ where it does not happen within the bound.

    Attributes:
        radius: of each random direction, (directions,).
        improved: radius after the local search, (improved,), in the order of ``radius``.
        vector: the smallest vector found, NaN without one.
    """

    radius: Array
    improved: Array
    vector: Array


def search(
    happens: Happens,
    size: int,
    bound: float,
    count: int,
    generator: np.random.Generator,
) -> SearchResult:
    """The smallest vector of Euclidean norm up to ``bound`` for which something happens."""
    unit = _normalized(generator.standard_normal((count, size)))
    radius = _along(happens, unit, bound)
    best = np.argsort(radius, kind="stable")[:IMPROVED]
    best = best[np.isfinite(radius[best])]
    improved = np.full(IMPROVED, np.inf)
    if not best.size:
        return SearchResult(radius, improved, np.full(size, np.nan))
    directions, radii = _improve(happens, unit[best], radius[best], generator)
    improved[: best.size] = radii
    smallest = int(np.argmin(radii))
    return SearchResult(radius, improved, directions[smallest] * radii[smallest])


def _normalized(vectors: Array) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _along(happens: Happens, unit: Array, bound: float) -> Array:
    """Radius along each direction at which it first happens, to the last halving, or ∞."""
    levels = bound * np.arange(1, effort.radii + 1) / effort.radii
    first = np.full(len(unit), np.inf)
    for level in levels:
        left = np.flatnonzero(np.isinf(first))
        if left.size:
            first[left[happens(level * unit[left])]] = level
    rows = np.flatnonzero(np.isfinite(first))
    first[rows] = _bisect(
        happens, unit[rows], first[rows] - levels[0], first[rows], effort.halvings
    )
    return first


def _bisect(
    happens: Happens, unit: Array, low: Array, high: Array, halvings: int
) -> Array:
    """The upper ends of intervals in which it does not happen below and happens above."""
    # few vectors cost nearly as much as this many, so several halvings are tried at once
    together = 24
    at_once = int(np.log2(together / max(len(unit), 1) + 1.0))
    columns = np.arange(len(unit))
    while halvings and len(unit):
        levels = max(1, min(halvings, at_once))
        radii = np.stack([low, high])
        for _ in range(levels):
            middle = 0.5 * (radii[:-1] + radii[1:])
            radii = np.insert(radii, range(1, len(radii)), middle, axis=0)
        tried = (radii[1:-1, :, None] * unit).reshape(-1, unit.shape[1])
        yes = happens(tried).reshape(-1, len(unit))
        below = np.zeros(len(unit), int)  # radii of which it does not happen
        for half in 2 ** np.arange(levels)[::-1]:
            below += np.where(yes[below + half - 1, columns], 0, half)
        low, high = radii[below, columns], radii[below + 1, columns]
        halvings -= levels
    return high


def _improve(
    happens: Happens, unit: Array, radius: Array, generator: np.random.Generator
) -> tuple[Array, Array]:
    """Directions moved by random steps to smaller radii, all of them side by side."""
    unit, radius = unit.copy(), radius.copy()
    step = np.full(len(unit), effort.first_step)
    for _ in range(effort.rounds):
        moves = generator.standard_normal((len(unit), effort.tries, unit.shape[1]))
        tried = _normalized(unit[:, None] + step[:, None, None] * _normalized(moves))
        below = (1.0 - effort.gain * step / effort.first_step) * radius
        works = happens((below[:, None, None] * tried).reshape(-1, unit.shape[1]))
        works = works.reshape(len(unit), effort.tries)
        owner, which = np.nonzero(works & (np.cumsum(works, axis=1) <= effort.followed))
        bisected = _bisect(
            happens,
            tried[owner, which],
            0.5 * below[owner],
            below[owner],
            effort.refinement * effort.halvings,
        )
        for row in range(len(unit)):
            mine = np.flatnonzero(owner == row)
            if mine.size:
                best = mine[np.argmin(bisected[mine])]
                unit[row], radius[row] = tried[row, which[best]], bisected[best]
            else:
                step[row] *= effort.shrink
    return unit, radius


def smallest_linear(matrix: Array, row: Array, level: float, t_end: float) -> float:
    """The smallest vector z0 with which ż = A z takes c·z to a level in [0, t_end], in closed form.

    At an instant c·z = (c exp(A t))·z0, so the smallest z0 that is at the level then has the length
    level/|c exp(A t)|, and the largest of these rows decides.
    """
    rate = max(float(np.abs(np.linalg.eigvals(matrix)).max()), 1.0 / t_end)
    # step of the scan in time, over the shortest time scale
    phase = 0.02
    # 160 MB of rows, and seconds
    most_steps = 5e6
    if not rate * t_end <= most_steps * phase:
        raise ValueError(
            f"the linear motion changes within 1/{rate * t_end:.2g} of the horizon, at most "
            f"1/{most_steps * phase:.0e} is scanned; shorten t_end, or weaken a dashpot or a spring"
        )
    count = int(np.ceil(rate * t_end / phase)) + 1
    step = t_end / count
    move, rows = scipy.linalg.expm(step * matrix), np.empty((count + 1, len(row)))
    rows[0] = row
    for index in range(count):
        rows[index + 1] = rows[index] @ move
    longest = int(np.argmax(np.linalg.norm(rows, axis=1)))
    low, high = step * max(longest - 1, 0), step * min(longest + 1, count)
    best = scipy.optimize.minimize_scalar(
        lambda time: -float(np.linalg.norm(row @ scipy.linalg.expm(time * matrix))),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-9 * step},
    )
    return level / max(-float(best.fun), float(np.linalg.norm(rows[longest])))
