"""Find how much more damping stops the modes that grow."""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from squealpipe.schema import Outcome
from squealpipe.structures.agreement import Truth
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import Kept
from squealpipe.structures.schema.squealing import MOST_DAMPING
from squealpipe.structures.spectrum import Limits, Solver, Spectrum
from squealpipe.structures.squeal.plant import Plant


def added_damping(plant: Plant) -> tuple[float, Outcome]:
    """Return the smallest ratio of damping, added to every mode at rest, from which no mode grows.

    Damping may destabilize before it stabilizes: from this ratio to the largest tried nothing
    grows. It is found in the modes that are run, and confirmed in the whole structure: there modes
    grow with 1 % less, and none with 1 % more. Where that fails, the whole structure is searched if
    its matrices are dense and no band limits its modes.

    Returns:
        The ratio and its outcome: 0 where nothing grows without it, NaN where the largest does not
        suffice (``not_reached``) or where it is not known (``unresolved``).
    """
    ratio = _searched(plant.structure)
    origin = plant.structure.reduced_from
    if origin is not None and not _confirmed(plant, ratio):
        if origin.whole.size > DENSE or origin.frequency_max is not None:
            return np.nan, Outcome.unresolved
        ratio = _searched(origin.whole)
    known = math.isfinite(ratio)
    return ratio, Outcome.converged if known else Outcome.not_reached


def _confirmed(plant: Plant, ratio: float) -> bool:
    """Tell whether modes of the whole grow with 1 % less damping, and none with 1 % more."""
    origin, truth = plant.structure.reduced_from, plant.truth
    assert origin is not None and truth is not None  # noqa: S101, PT018
    grows_now = bool(truth.unstable.size)
    if ratio == 0.0 or not grows_now:
        return grows_now == (ratio != 0.0)

    def grows(added: float) -> bool:
        ratios = origin.whole.modal_damping
        if ratios.ndim and origin.whole.size <= DENSE:  # those without a ratio have 0
            ratios = np.pad(ratios, (0, origin.whole.size - len(ratios)))
        damped = origin.whole.with_(modal_damping=ratios + added)
        return bool(Truth.of(damped, origin.frequency_max).unstable.size)

    if not math.isfinite(ratio):
        return grows(MOST_DAMPING)
    return grows(0.99 * ratio) and not grows(1.01 * ratio)


def _searched(structure: ContactStructure) -> float:
    """Return the ratio that one structure needs by itself, NaN if the largest does not suffice."""
    now = _spectrum(structure)
    if not (now.values.real > now.growth_errors).any():
        return 0.0
    growth = _growth_over_ratio(structure)
    # ratios of damping between which stability is taken to change once at most
    tried, above = np.geomspace(1e-4, MOST_DAMPING, 24)[::-1].tolist(), math.nan
    # from the largest down to the first at which a mode grows
    for ratio in [*tried, 0.0]:
        if ratio == 0.0 or growth(ratio) > 0:
            break
        above = ratio
    if math.isnan(above):
        return math.nan
    return float(brentq(growth, ratio, above, xtol=1e-9))


def _growth_over_ratio(structure: ContactStructure) -> Callable[[float], float]:
    """Return the largest growth rate, 1/s, as a function of the ratio of damping added."""
    # in coordinates of its modes what damps it already is in its matrix, and ratios are free
    kept = Kept(structure, structure.size)
    if structure.size > 32:  # eigenvalues to their last digits would take too long
        return lambda ratio: float(kept.quick_values(structure.size, ratio).real.max())
    modal = kept.reduced(structure.size)
    return lambda ratio: float(
        _spectrum(modal.with_(modal_damping=ratio)).values.real.max()
    )


def _spectrum(structure: ContactStructure) -> Spectrum:
    return Solver(structure, Limits(), structure.belt_speed).at(structure.mu)
