"""Take degrees of freedom that a penalty holds, or that have next to no mass, out of a pencil.

Programs fix a degree of freedom by a stiffness of 1e20 to 1e36 on its diagonal. Round-off of
that entry would hide all other eigenvalues. So such rows are condensed: x = R x_a with
R = [1; −K_bb⁻¹ K_ba], which for a penalty is x_b = 0, and for a mass that is next to nothing its
static displacement. Rows are measured against each other one by one, never against the largest
entry: there must be a gap that no mechanical structure has.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as la


@dataclass(frozen=True)
class Gap:
    """Thresholds of the gap in K_ii/M_ii between the rows that are kept and those taken out.

    Attributes:
        least: smallest ratio of both sides, where the stiff side is beyond ``mechanical``. Doubled,
            penalties near 1e20 on a stiff body stay in, and cost digits.
        mechanical: (rad/s)², 16 MHz; the modes of a mesh of bodies are below.
        alone: smallest ratio of both sides where the stiff side is below ``mechanical``, for rows
            whose coupling is round-off. If it were smaller, rigid bodies on springs of almost no
            stiffness would be split off from what is elastic.
        conditioned: smallest reciprocal condition of K_bb. A rigid link holds two rows to each
            other but to nothing else, and is not condensed.
    """

    least: float = 1e8
    mechanical: float = 1e16
    alone: float = 1e12
    conditioned: float = 1e-8


def stiff_degrees(
    mass: np.ndarray, stiffness: np.ndarray, damping: np.ndarray | None = None
) -> Any:
    """Return a mask of the degrees of freedom that are taken out, (n,).

    A row with next to no mass on a dashpot lags behind the others: it is not taken out.
    """
    size = len(mass)
    none = np.zeros(size, bool)
    ratios = np.abs(stiffness.diagonal()) / mass.diagonal()
    order = np.argsort(ratios, kind="stable")
    ascending = ratios[order]
    for index in range(1, size):
        below, above = ascending[index - 1], ascending[index]
        if not below > 0 or not above > Gap.least * below:
            continue
        stiff = none.copy()
        stiff[order[index:]] = True
        held = above >= Gap.mechanical or (
            above > Gap.alone * below and _is_apart(stiffness, stiff)
        )
        late = damping is not None and _is_late(damping, stiffness, stiff, below)
        if held and not late and _is_regular(stiffness[np.ix_(stiff, stiff)]):
            return stiff
    return none


def _is_late(
    damping: np.ndarray, stiffness: np.ndarray, stiff: np.ndarray, below: float
) -> bool:
    """Tell whether dampers of stiff rows matter at the kept rows' frequencies.

    A penalty has its share of modal damping, but next to nothing of it reaches the kept rows.
    """
    largest = np.maximum(np.abs(damping).max(axis=0), np.abs(damping).max(axis=1))
    springs = np.abs(stiffness.diagonal())
    forces = np.abs(stiffness) + np.sqrt(below) * np.abs(damping)
    across, back = forces[np.ix_(~stiff, stiff)], forces[np.ix_(stiff, ~stiff)]
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = (across * back.T) / np.outer(springs[~stiff], springs[stiff])
    # of a kept row's spring; a row without one depends wholly on the stiff ones
    share = np.fmin(np.nan_to_num(shares, nan=0.0), 1.0).max(axis=0, initial=0.0)
    late = largest[stiff] * np.sqrt(below) * share
    # polishing needs eight digits; the springs of penalties exceed their dampers by far more
    return bool((late > 1e-8 * springs[stiff]).any())


def beyond_gap(mass: np.ndarray, stiffness: np.ndarray) -> int:
    """Count the rows that a penalty fixes, by the diagonals of both matrices alone."""
    ratios = np.sort(np.abs(stiffness) / mass)
    above = (ratios[1:] > Gap.least * ratios[:-1]) & (ratios[:-1] > 0)
    places = np.flatnonzero(above & (ratios[1:] >= Gap.mechanical))
    return len(ratios) - 1 - int(places[0]) if places.size else 0


def _is_apart(stiffness: np.ndarray, stiff: np.ndarray) -> bool:
    """Tell whether stiff rows are coupled to the others, and by no more than round-off."""
    across = np.abs(stiffness[np.ix_(~stiff, stiff)])
    back = np.abs(stiffness[np.ix_(stiff, ~stiff)])
    diagonal = np.abs(stiffness.diagonal())
    limit = np.finfo(float).eps * np.outer(diagonal[~stiff], diagonal[stiff])
    coupled = (across > 0).any(axis=0) | (back > 0).any(axis=1)
    return bool(coupled.all() and (across * back.T <= limit).all())


def _is_regular(block: np.ndarray) -> bool:
    scale = 1.0 / np.sqrt(np.abs(block.diagonal()))
    sizes = la.svdvals(scale[:, None] * block * scale)
    return bool(sizes[-1] > Gap.conditioned * sizes[0])


def condensation(stiffness: np.ndarray, stiff: np.ndarray) -> np.ndarray:
    """Return R, (n, kept), which maps kept degrees of freedom to all by K x = 0 in stiff rows."""
    kept = np.flatnonzero(~stiff)
    basis = np.zeros((len(stiff), len(kept)))
    basis[kept, np.arange(len(kept))] = 1.0
    # penalties differ by any factor: with a unit diagonal none of them is lost
    scale = 1.0 / np.sqrt(np.abs(stiffness.diagonal()[stiff]))
    block = scale[:, None] * stiffness[np.ix_(stiff, stiff)] * scale
    across = scale[:, None] * stiffness[np.ix_(stiff, ~stiff)]
    basis[stiff] = -scale[:, None] * la.solve(block, across)
    return basis
