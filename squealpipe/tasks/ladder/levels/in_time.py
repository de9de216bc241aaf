"""A model integrated in time over a part of the horizon."""

from __future__ import annotations

import numpy as np

from squealpipe.laws.friction import slides
from squealpipe.methods.processes import cpu_time
from squealpipe.schema import Outcome
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.ladder.levels.answers import Answers, Scenes
from squealpipe.tasks.ladder.questions import answer_of
from squealpipe.tasks.sampling import sample_times


def answer(level: Level, scenes: Scenes) -> Answers:
    """Answers of ``level.model`` over ``level.share`` of the horizon."""
    started = cpu_time()
    params, alpha1, alpha2, horizon, workers = scenes
    end = level.share * horizon
    times = sample_times(params, end)
    found = run_ensemble(
        params, alpha1, alpha2, t_end=end, model=level.model, times=times, workers=workers
    )
    values = np.stack([answer_of(found, question, times) for question in QUESTIONS])
    holds = found.outcome == Outcome.converged
    if level.model == "A4":
        holds &= slides(found.max_vx, params)
    valid = np.broadcast_to(holds, values.shape)
    seconds = cpu_time() - started
    reached = found.sticks + found.slips + found.reversals > 0
    return Answers(values, valid, seconds, reached)
