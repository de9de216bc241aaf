"""Variants of A1, and A4: each leaves something out of it."""

from typing import NamedTuple


class Rules(NamedTuple):
    """Parts that a variant keeps (True) or leaves out.

    Friction that does not drag is Eq. (4) as printed: both coefficients change their sign. Belt
    speed then repels: it is never held, and a mass exactly at it with |x-force of the springs| < μN
    could leave to either side. It leaves to the side that the springs pull to, below belt speed
    where they do not.
    """

    separates: bool = True
    reverses: bool = True
    sticks: bool = True
    linear_springs: bool = False
    drags: bool = True


VARIANT_RULES: dict[str, Rules] = {
    "A1": Rules(),
    "A1-no-stick": Rules(sticks=False),
    "A1-no-separation": Rules(separates=False),
    "A1-linear-springs": Rules(linear_springs=True),
    "A1-as-printed": Rules(sticks=False, drags=False),
    "A1-as-printed-no-separation": Rules(separates=False, sticks=False, drags=False),
    "A4": Rules(reverses=False, sticks=False, linear_springs=True),
}
