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


class Worded(IntEnum):
    """Flags that people read in words; datasets and tables keep their names."""

    @property
    def words(self) -> str:
        """The flag as people read it, everywhere: its name, where its class has no other word."""
        return self.name.replace("_", " ")


class Verdict(Worded):
    """Verdict on a motion: what it ends in."""

    quiet = 0
    squeals = 1
    hammers = 2
    undetermined = 3

    @property
    def opening(self) -> str:
        """Words of the verdict with a capital, to begin a sentence."""
        return self.words.capitalize()


def flag_words(name: str) -> str:
    """Return a flag's name, as datasets store it, as people write it."""
    if name in Verdict.__members__:
        return Verdict[name].words
    return (
        name.replace("quasi_", "quasi-")
        .replace("stick_slip", "stick–slip")
        .replace("_", " ")
    )
