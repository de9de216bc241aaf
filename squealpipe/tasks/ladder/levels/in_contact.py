"""What the levels share that know the linear motion in contact alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from squealpipe.laws.friction import slides
from squealpipe.methods.modal_bounds import ModalMotion, modal_motion
from squealpipe.methods.processes import cpu_time
from squealpipe.models import a3, a4
from squealpipe.models.contact_system import contact_system
from squealpipe.parameters import Parameters
from squealpipe.schema.ladder import QUESTIONS
from squealpipe.tasks.ladder.levels.answers import Answers


def contact_motion(params: Parameters, alpha1: Any, alpha2: Any) -> ModalMotion:
    """The linear motion from rest that never leaves contact (A3, Eqs. (6), (7))."""
    alpha1, alpha2 = np.asarray(alpha1, float), np.asarray(alpha2, float)
    stiffness, determinant, invariants = contact_system(params, alpha1, alpha2)
    x, y, _ = a3.static_state(
        stiffness, determinant, k3=params.k3, mu=params.drag, actuation=params.k3 * params.preload
    )
    a11, a12, a21, a22 = (
        value / params.mass for value in a4.contact_matrix(stiffness, params.k3, params.drag)
    )
    first, second = a4.natural_frequencies_squared(invariants)
    return modal_motion((a11, a12, a21, a22), (first, second), (x, y))


def linear_answers(
    values: np.ndarray, motion: ModalMotion, params: Parameters, started: float
) -> Answers:
    """Answers from the linear motion: none where it does not oscillate.

    Only contact lost may be asked of a motion that leaves contact.
    """
    slow = motion.oscillates & slides(motion.fastest(), params)
    stays = slow & (motion.highest() < params.preload)
    valid = np.stack([slow, *[stays] * (len(QUESTIONS) - 1)])
    answered = np.where(motion.oscillates, values, np.nan)
    return Answers(answered, valid, cpu_time() - started)
