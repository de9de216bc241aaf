"""Where steady sliding turns unstable as friction grows."""

import math
from dataclasses import dataclass, replace

import numpy as np

from squealpipe.schema.squealing import ABOVE
from squealpipe.schema.structures import Onset
from squealpipe.systems.structures.complex_modes import complex_modes
from squealpipe.systems.structures.definition import Structure
from squealpipe.systems.structures.squeal.plant import Plant

BEYOND, POINTS = 2.0, 24
"""Where nothing grows: so far beyond its own friction an onset is sought, at so many places."""
BELOW = 0.99
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


def first_onset(plant: Plant) -> FirstOnset | None:
    """None if there is none up to twice the structure's friction, or none that is located."""
    structure, modes = plant.structure, plant.modes
    if (modes.onset == Onset.unstable_throughout).any():
        return None
    if not plant.unstable.size:
        frictions = np.linspace(1.0, BEYOND, POINTS) * structure.mu
        frictions = frictions[frictions <= most_friction(structure)]
        if len(frictions) < 2 or not structure.mu:
            return None
        modes = complex_modes(structure, mu=frictions)
    critical = modes.critical_mu.values
    mu = float(np.nanmin(critical, initial=math.inf))
    if ABOVE * mu > most_friction(structure) or not math.isfinite(mu):
        return None
    above = Plant(structure.with_(mu=ABOVE * mu))
    if not above.unstable.size:
        return None
    frequency = float(above.frequencies[above.unstable[0]])
    return FirstOnset(
        mu, frequency, above, Plant(structure.with_(mu=BELOW * mu)).decays
    )


def most_friction(structure: Structure) -> float:
    """Friction of sliding that the limit of stick allows, where one is given; else infinite."""
    friction = structure.friction
    if friction.mu_static is None or not friction.mu:
        return math.inf
    onset = replace(friction, mu_static=None).static_mu
    return friction.mu * friction.mu_static / onset if onset else math.inf
