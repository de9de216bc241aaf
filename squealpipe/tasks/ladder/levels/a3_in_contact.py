"""The linear motion in contact, sampled over the horizon."""

from __future__ import annotations

import numpy as np

from squealpipe.methods.processes import cpu_time
from squealpipe.schema.ladder import QUESTIONS
from squealpipe.tasks.ladder.levels.answers import Answers, Scenes
from squealpipe.tasks.ladder.levels.in_contact import contact_motion, linear_answers
from squealpipe.tasks.ladder.questions import answer_of_samples
from squealpipe.tasks.sampling import sample_times


def answer(scenes: Scenes) -> Answers:
    """Answers from the sum of both modes."""
    started = cpu_time()
    params = scenes.params
    motion = contact_motion(params, scenes.alpha1, scenes.alpha2)
    times = sample_times(params, scenes.horizon)
    x, y = motion.positions(times)
    values = np.stack([answer_of_samples(x, y, name, params, times) for name in QUESTIONS])
    return linear_answers(values, motion, params, started)
