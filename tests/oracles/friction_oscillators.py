"""Two published one-mass oscillators as limits of A1.

A1 holds both as the limit of long springs and a soft contact under a large preload: spring 1 is
vertical and carries N, spring 2 lies along the belt. What is left is of order 1/length.
"""

import math

from tests.former import FORMER

ANGLES = (0.5 * math.pi, math.pi)
STEADY = 0.25
"""y at which spring 1 of stiffness 4 balances N = 1."""
LEINE = {
    "mu": 0.0,
    "mu_static": 1.0,
    "friction_speed": 1 / 3,
    "friction_law": "hyperbolic",
    "damping1": 0.4,
}
BSTAB = {
    "mu": 0.5,
    "mu_static": 1.0,
    "friction_speed": 0.5,
    "friction_law": "exponential",
    "damping1": 0.4,
    "damping2": 0.1,
}
"""m = k = 1, c = 0.1, friction 0.5 + 0.5 exp(−2 w)."""


def oscillator(length, belt_speed, **friction):
    """The oscillator's limit: N = 1 to 1/length, k = 1 along the belt."""
    return FORMER.with_(
        k1=4.0,
        k2=1.0,
        k3=1.0 / length,
        preload=length,
        length1=length,
        length2=length,
        belt_speed=belt_speed,
        **friction,
    )
