"""A4 by closed-form flow from switch to switch, cell by cell."""

from __future__ import annotations

import numpy as np

from squealpipe.laws.friction import slides
from squealpipe.methods.orbits.modal_trajectory import trajectory_from_rest
from squealpipe.methods.processes import cpu_time
from squealpipe.schema.ladder import QUESTIONS
from squealpipe.solvers.a4.system import scaled_system
from squealpipe.tasks.ladder.levels.answers import Answers, Scenes
from squealpipe.tasks.ladder.questions import answer_of_samples
from squealpipe.tasks.sampling import sample_times


def answer(scenes: Scenes) -> Answers:
    """Answers from exact samples; the separations are those of the flow."""
    params, alpha1, alpha2, horizon, _ = scenes
    times = sample_times(params, horizon)
    states = np.empty((len(times), 4))
    values = np.full((len(QUESTIONS), len(alpha1)), np.nan)
    valid = np.zeros(values.shape, dtype=bool)
    trajectory_from_rest(
        scaled_system(params, 1.0, 1.0).system.rows, times[:2], states
    )  # compile off the clock
    started = cpu_time()
    for cell, (first, second) in enumerate(zip(alpha1, alpha2, strict=True)):
        scene = scaled_system(params, first, second)
        switches = trajectory_from_rest(scene.system.rows, times * scene.frequency, states)
        if switches < 0:
            continue
        x, y = states[:, 0] * scene.length, states[:, 1] * scene.length
        speed = states[:, 2].max() * scene.length * scene.frequency
        values[:, cell] = [
            float(answer_of_samples(x, y, name, params, times)) for name in QUESTIONS
        ]
        values[0, cell] = float(switches > 0)
        valid[:, cell] = slides(speed, params)
    return Answers(values, valid, cpu_time() - started)
