"""What a level of the model ladder is asked, and what it answers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squealpipe.parameters import Parameters


class Scenes(NamedTuple):
    """What every level is asked about: cells of the map, V not negative; times in s."""

    params: Parameters
    alpha1: np.ndarray
    alpha2: np.ndarray
    horizon: float
    workers: int | None


class Answers(NamedTuple):
    """Answers (question, cell) of one level, where its own assumptions hold, and what they cost.

    Attributes:
        values: in the order of :data:`squealpipe.schema.ladder.QUESTIONS`; NaN: there is none.
        valid: whether they may be trusted.
        seconds: CPU time.
        belt_reached: whether the mass reaches belt speed in contact.
    """

    values: np.ndarray
    valid: np.ndarray
    seconds: float
    belt_reached: np.ndarray | None = None
