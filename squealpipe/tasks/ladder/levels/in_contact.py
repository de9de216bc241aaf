"""What the levels share that know the linear motion in contact alone."""

from __future__ import annotations

import numpy as np

from squealpipe.laws.friction import slides
from squealpipe.methods.modal_bounds import ModalMotion
from squealpipe.parameters import Parameters
from squealpipe.schema.ladder import QUESTIONS


def linear_validity(motion: ModalMotion, params: Parameters) -> np.ndarray:
    """Only contact lost may be asked of a motion that leaves contact."""
    slow = motion.oscillates & slides(motion.fastest(), params)
    stays = slow & (motion.highest() < params.preload)
    return np.stack([slow, *[stays] * (len(QUESTIONS) - 1)])
