"""What a point of a branch of cycles is; apart from what finds it, which compiles."""

from enum import IntEnum


class Label(IntEnum):
    """What a point of a branch is."""

    regular = 0
    fold = 1
    period_doubling = 2
    torus = 3
    grazing = 4
    stick_onset = 5
    end = 6
