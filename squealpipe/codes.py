"""The codes that models, methods and datasets share."""

from enum import IntEnum


class Regime(IntEnum):
    """Regimes of A1."""

    slip_slower = 0
    slip_faster = 1
    stick = 2
    separated = 3


class Event(IntEnum):
    """Kinds of events of A1."""

    separation = 0
    contact = 1
    stick = 2
    slip = 3
    reversal = 4


class LinearRegime(IntEnum):
    """Stability regimes of A3."""

    stable = 0
    flutter = 1
    divergence = 2


class SpecialPoint(IntEnum):
    """Event at a special point of a branch of periodic orbits."""

    period_doubling = 0
    index_two = 1
    fold = 2


class Verdict(IntEnum):
    """Verdict on a motion: what it ends in."""

    quiet = 0
    squeals = 1
    hammers = 2
    undetermined = 3
