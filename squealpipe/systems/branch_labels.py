"""Labels of the points of branches and curves of cycles; apart from what finds them, which
compiles.
"""

from enum import IntEnum


class Label(IntEnum):
    """Label of a point of a branch."""

    regular = 0
    fold = 1
    period_doubling = 2
    torus = 3
    grazing = 4
    stick_onset = 5
    end = 6
    pitchfork = 7
    transcritical = 8
    border_collision = 9
    """a change of the events that is neither, at which the stability jumps"""
    family_member = 10
    """the branch goes on at this value of the parameter alone, through a family of cycles"""


class Meeting(IntEnum):
    """Further event at a point of a curve."""

    regular = 0
    cusp = 1
    fold_flip = 2
    fold_grazing = 3
    flip_grazing = 4
    stick_onset = 5
    end_of_leg = 6
    end = 7
    resonance_1_1 = 8
    resonance_1_2 = 9
    resonance_1_3 = 10
    resonance_1_4 = 11
