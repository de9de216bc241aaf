"""Find how much more damping stops the modes that grow.

Idea: from the largest ratio down, the first of a row of ratios at which a mode grows brackets the
boundary in the modes that are run; there the fastest growth passes zero. Growth rates of the whole
structure differ by some per cent, so secants of its fastest growth lead from there to its own
boundary.

Invariant: just above the ratio that is returned nothing grows. Cost: one problem of eigenvalues for
each ratio tried, of the whole structure three or four.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from squealpipe.schema import Outcome
from squealpipe.structures.agreement import Truth
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.definition import ContactStructure, ReducedFrom
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import quick_values
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.squeal.plant import Plant

Growth = Callable[[float], float]
"""Ratio of damping that is added to every mode at rest → fastest growth beyond its error, 1/s."""


def added_damping(plant: Plant) -> tuple[float, Outcome]:
    """Return the smallest ratio of damping, added to every mode at rest, from which no mode grows.

    Damping may destabilize before it stabilizes: from this ratio to the largest tried nothing
    grows. It is found in the modes that are run, and located from there in the whole structure.

    Returns:
        The ratio and its outcome: 0 where nothing grows without it, NaN where the largest does not
        suffice (``not_reached``) or where it is not known (``unresolved``).
    """
    ratio = boundary(growth_of(plant.structure)) if plant.unstable.size else 0.0
    origin, truth = plant.structure.reduced_from, plant.truth
    if origin is not None and truth is not None:
        is_quick = origin.whole.size <= DENSE and origin.frequency_max is None
        growth = growth_of(origin.whole) if is_quick else growth_in_band(origin)
        located = located_near(growth, ratio, _fastest(truth))
        if located is None and not is_quick:
            return np.nan, Outcome.unresolved
        ratio = boundary(growth) if located is None else located
    known = math.isfinite(ratio)
    return ratio, Outcome.converged if known else Outcome.not_reached


def growth_of(structure: ContactStructure) -> Growth:
    """Return the fastest growth of all modes of a structure, by dense algebra."""
    kept = Coordinates(StaticSpace(structure, structure.size), structure.size, 0)
    stiffness, damping = kept.small_motions()

    def growth(ratio: float) -> float:
        added = np.diag(2.0 * ratio * kept.omega)
        values = quick_values(stiffness, damping + added)
        # growth below this share of the modulus is round-off
        return float((values.real - 1e-9 * np.abs(values)).max())

    return growth


def growth_in_band(origin: ReducedFrom) -> Growth:
    """Return the fastest growth of the modes of a whole structure up to the end of its band."""
    whole, ratios = origin.whole, origin.whole.modal_damping
    if ratios.ndim and whole.size <= DENSE:  # those without a ratio have 0
        ratios = np.pad(ratios, (0, whole.size - len(ratios)))

    def growth(ratio: float) -> float:
        damped = whole.with_(modal_damping=ratios + ratio)
        return _fastest(Truth.of(damped, origin.frequency_max))

    return growth


def _fastest(truth: Truth) -> float:
    growth = truth.values.real - truth.spectrum.growth_errors
    return float(growth[truth.within].max())


def boundary(growth: Growth) -> float:
    """Return the ratio from which nothing grows; NaN if the largest does not suffice."""
    # ratios of damping between which stability is taken to change once at most
    above = SquealLimits.most_damping
    for ratio in [*np.geomspace(1e-4, above, 24)[::-1].tolist(), 0.0]:
        if growth(ratio) > 0.0:
            if ratio == SquealLimits.most_damping:
                return math.nan
            return float(brentq(growth, ratio, above, xtol=1e-12))
        above = ratio
    return 0.0


def located_near(growth: Growth, ratio: float, now: float) -> float | None:
    """Return the boundary near a ratio, by secants that begin there and without added damping.

    Args:
        ratio: boundary in the modes that are run; NaN: the largest does not suffice there.
        now: fastest growth without added damping, 1/s.

    Returns:
        NaN where the largest does not suffice, None where the search has come to no ratio.
    """
    if ratio == 0.0 or now <= 0.0:
        return ratio if (now > 0.0) == (ratio != 0.0) else None
    if not math.isfinite(ratio):
        return ratio if growth(SquealLimits.most_damping) > 0.0 else None
    before, last = 0.0, now
    # growth is nearly linear in the ratio: secants end within a few steps, or not at all
    for _ in range(5):
        now = growth(ratio)
        if (now - last) * (ratio - before) >= 0.0:  # more damping destabilizes
            return None
        step = now * (ratio - before) / (now - last)
        before, ratio, last = ratio, ratio - step, now
        if not 0.0 < ratio <= SquealLimits.most_damping:
            return None
        if abs(step) < 0.01 * before and growth(1.01 * ratio) <= 0.0:
            return ratio
    return None
