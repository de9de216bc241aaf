"""First onset: the friction at which steady sliding turns unstable as friction grows."""

import math
from dataclasses import dataclass

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.structures.complex_modes import complex_modes
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.sliding import NoSlidingError
from squealpipe.structures.squeal.plant import Plant


@dataclass(frozen=True)
class FirstOnsetSearch:
    """Range in which the onset of squeal is sought."""

    searched_factor: float = 2.0
    """Factor of the structure's own friction up to which an onset is sought where nothing grows."""
    below: float = 0.99
    """Friction over that of the onset at which small motions have to die out."""


@dataclass(frozen=True)
class FirstOnset:
    """The smallest friction from which steady sliding is unstable.

    Attributes:
        mu: of it.
        frequency: of the mode that turns unstable, Hz.
        above: the structure just above it.
        damped: whether small motions die out just below.
    """

    mu: float
    frequency: float
    above: Plant
    damped: bool


def confirmed_onset(plant: Plant) -> FirstOnset | Outcome:
    """Return where steady sliding turns unstable, if the whole structure does so within 1 % of it.

    It is sought in the modes that are run, and unresolved where the whole structure disagrees.
    """
    found = first_onset(plant)
    if plant.structure.reduced_from is None or found is Outcome.unresolved:
        return found

    def grows(mu: float) -> bool:
        try:
            return bool(plant.truth_at(mu).unstable.size)
        except NoSlidingError:
            return False

    most = min(
        FirstOnsetSearch.searched_factor * plant.structure.mu,
        plant.structure.largest_mu,
    )
    if isinstance(found, FirstOnset):
        agrees = grows(SquealLimits.above * found.mu) and not grows(
            FirstOnsetSearch.below * found.mu
        )
    elif found is Outcome.already_unstable:
        agrees = grows(0.0)
    else:
        agrees = not grows(most)
    return found if agrees else Outcome.unresolved


def first_onset(plant: Plant) -> FirstOnset | Outcome:
    """Return the friction of the first onset, or why it is not known.

    Already unstable: without friction. Not reached: up to twice the structure's friction, or to
    what its limit of stick allows, no mode turns unstable. Unresolved: it could not be located.
    """
    structure, modes = plant.structure, plant.modes
    most = structure.largest_mu
    if (modes.onset == Onset.unstable_throughout).any():
        return Outcome.already_unstable
    if not plant.unstable.size:
        frictions = (
            np.linspace(1.0, FirstOnsetSearch.searched_factor, 24) * structure.mu
        )
        frictions = frictions[frictions <= most]
        if len(frictions) < 2 or not structure.mu:
            return Outcome.not_reached
        modes = complex_modes(structure, mu=frictions)
    mu = float(np.nanmin(modes.critical_mu.values, initial=math.inf))
    if SquealLimits.above * mu > most or not math.isfinite(mu):
        lost = (modes.onset == Onset.not_followed).any()
        return Outcome.unresolved if lost else Outcome.not_reached
    above = Plant(structure.with_(mu=SquealLimits.above * mu))
    if not above.unstable.size:
        return Outcome.unresolved
    frequency = float(above.frequencies[above.unstable[0]])
    return FirstOnset(
        mu,
        frequency,
        above,
        Plant(structure.with_(mu=FirstOnsetSearch.below * mu)).decays,
    )
