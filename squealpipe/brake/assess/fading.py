"""Show that a pad which slides dies out, long before it has become small.

Idea: with little damping a push or strike of a quiet pad slides for thousands of periods before it
is small, and nothing but its slow decay happens. In the modes of small motions that decay shows
within some hundred periods: amplitudes neither beat nor depend on the phase. If each mode that
matters decays at its own linear rate, then what springs and friction do beyond their linear parts
is only a small share of that at this amplitude, and still less of it at the smaller ones that
follow. If, besides, the linear motion from here on keeps clear of contact loss and of the belt's
speed, neither happens any more.

Invariant: what is not shown is run as before. A mode that decays too slowly to be seen beside the
ripple of nonlinear springs, modes that exchange energy, and tables, whose knots are no small
deviation, are never shown. Cost: four hundred periods.
"""

from dataclasses import dataclass

import numpy as np

from squealpipe.brake.assess.sliding import Sliding
from squealpipe.laws.tables import is_table


@dataclass(frozen=True)
class Fading:
    """Thresholds; each comment says what another value would do."""

    periods: float = 400.0
    """Periods that are run to see the decay. Half as many: ripples hide decays twice as fast."""
    worth: float = 10.0
    """Times these periods that the first window takes at least where they are run beforehand."""
    deviation: float = 0.25
    """Largest relative difference of a decay from the linear rate. Twice as much: what nonlinear
    forces add may be half of the decay."""
    matters: float = 1e-2
    """Share of a mode in the velocities from which its decay has to be seen."""
    clear: float = 0.8
    """Share of the way to contact loss, or to the belt's speed, that the motion may take up."""
    most_parallel: float = 1e4
    """Condition of the modes up to which amplitudes in them are told apart."""


def dies_out(sliding: Sliding, states: np.ndarray, length: float) -> bool:
    """Tell whether a motion without events is shown to die out.

    Args:
        states: at instants of equal distance, the last at the end of the run, (n, 4), m and m/s.
        length: time of the run, s.
    """
    design = sliding.design
    params = design.params
    if is_table(params.friction_law) or is_table(params.contact_law):
        return False
    # displacements and velocities of like sizes
    unit = np.array([1.0, 1.0, design.rate, design.rate])
    rates, modes = np.linalg.eig(sliding.jacobian * unit[None, :] / unit[:, None])
    if np.linalg.cond(modes) > Fading.most_parallel or not (rates.real < 0.0).all():
        return False
    away = (states - sliding.state) / unit
    amplitudes = np.abs(np.linalg.solve(modes, away.T))
    total = np.linalg.norm(amplitudes, axis=0)
    if not (total > 0.0).all():
        return False
    for rate, amplitude in zip(rates.real, amplitudes, strict=True):
        if (amplitude < Fading.matters * total).all():
            continue
        means = [part.mean() for part in np.array_split(np.log(amplitude), 4)]
        # from the first and the second quarter to those that follow half a run later
        seen = 2.0 / length * (np.array(means[2:]) - np.array(means[:2]))
        if not (np.abs(seen - rate) <= Fading.deviation * abs(rate)).all():
            return False
    farthest = np.abs(modes) @ amplitudes[:, -1] * unit
    room = params.preload - sliding.state[1], abs(params.belt_speed)
    return bool((farthest[[1, 2]] < Fading.clear * np.array(room)).all())
