"""Bounds of the linear motion for all times, and its dominant mode."""

from __future__ import annotations

import numpy as np

from squealpipe.methods.processes import cpu_time
from squealpipe.tasks.ladder.levels.answers import Answers, Scenes
from squealpipe.tasks.ladder.levels.in_contact import contact_motion, linear_answers


def answer(scenes: Scenes) -> Answers:
    """Answers without any instant."""
    started = cpu_time()
    params = scenes.params
    motion = contact_motion(params, scenes.alpha1, scenes.alpha2)
    dominant = np.abs(motion.y_mode).argmax(axis=-1)[..., None]
    values = np.stack(
        [
            (motion.highest() > params.preload).astype(float),
            np.take_along_axis(motion.omega, dominant, axis=-1)[..., 0],
            1.0 - motion.lowest() / params.preload,
            motion.farthest(),
        ]
    )
    return linear_answers(values, motion, params, started)
