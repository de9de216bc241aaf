"""How much more damping stops what grows."""

import numpy as np
from scipy.optimize import brentq

from squealpipe.schema.squealing import MOST_DAMPING
from squealpipe.systems.structures.definition import ContactStructure
from squealpipe.systems.structures.reduction import reduce
from squealpipe.systems.structures.spectrum import Limits, Solver, Spectrum

TRIED = np.geomspace(1e-4, MOST_DAMPING, 24)
"""Ratios between which stability is taken to change once at most."""


def added_damping(structure: ContactStructure) -> float:
    """The smallest ratio of damping, added to every mode at rest, from which no mode grows.

    Damping may destabilize before it stabilizes: from this ratio to the largest tried nothing
    grows. 0 where nothing grows without it, NaN where the largest does not suffice.
    """
    now = _spectrum(structure)
    if not (now.values.real > now.growth_errors).any():
        return 0.0
    # in coordinates of its modes what damps it already is in its matrix, and ratios are free
    modal = reduce(structure, n_modes=structure.size)
    growing = [_growth(modal, float(ratio)) > 0 for ratio in TRIED]
    if growing[-1]:
        return float("nan")
    last = int(np.flatnonzero([True, *growing])[-1])
    ends = [0.0, *TRIED.tolist()][last : last + 2]
    return float(brentq(lambda ratio: _growth(modal, ratio), *ends, xtol=1e-9))


def _growth(modal: ContactStructure, ratio: float) -> float:
    """The largest growth rate at this ratio, 1/s."""
    return float(_spectrum(modal.with_(modal_damping=ratio)).values.real.max())


def _spectrum(structure: ContactStructure) -> Spectrum:
    return Solver(structure, Limits(), structure.belt_speed).at(structure.mu)
