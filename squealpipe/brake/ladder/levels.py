"""Answers of each level of the model ladder over a map."""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.a1.ensemble import (
    LARGEST_CONTACT_FORCE,
    LARGEST_REACH,
    run_ensemble,
)
from squealpipe.brake.ladder.modal_bounds import ModalMotion, modal_motion
from squealpipe.brake.ladder.questions import answer_of, answer_of_samples
from squealpipe.brake.models import a3, a4
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.brake.sampling import sample_times
from squealpipe.brake.schema.ladder import QUESTIONS, Level
from squealpipe.laws.friction import slides
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome


class Scenes(NamedTuple):
    """Cells of the map that every level is asked about: V not negative; times in s."""

    params: Parameters
    alpha1: np.ndarray
    alpha2: np.ndarray
    horizon: float
    workers: int | None


class Answers(NamedTuple):
    """Answers (question, cell) of one level and where its own assumptions hold.

    Attributes:
        values: in the order of :data:`~squealpipe.brake.schema.ladder.QUESTIONS`;
            NaN: there is none.
        belt_reached: whether the mass reaches belt speed in contact.
    """

    values: np.ndarray
    valid: np.ndarray
    belt_reached: np.ndarray | None = None


def answer(level: Level, scenes: Scenes) -> Answers:
    """The answers of one level."""
    return _in_time(level, scenes) if level.model else _in_contact(scenes)


def contact_motion(params: Parameters, alpha1: Any, alpha2: Any) -> ModalMotion:
    """The linear motion from rest that never leaves contact (A3, Eqs. (6), (7))."""
    alpha1, alpha2 = np.asarray(alpha1, float), np.asarray(alpha2, float)
    stiffness, determinant, invariants = contact_system(params, alpha1, alpha2)
    x, y, _ = a3.static_state(
        stiffness,
        determinant,
        k3=params.k3,
        mu=params.drag,
        actuation=params.k3 * params.preload,
    )
    a11, a12, a21, a22 = (
        value / params.mass
        for value in a4.contact_matrix(stiffness, params.k3, params.drag)
    )
    squared = a4.natural_frequencies_squared(invariants)
    return modal_motion((a11, a12, a21, a22), squared, (x, y))


def _in_contact(scenes: Scenes) -> Answers:
    """The sum of both modes, sampled; none where it does not oscillate.

    Only contact lost may be asked of a motion that leaves contact.
    """
    params = scenes.params
    motion = contact_motion(params, scenes.alpha1, scenes.alpha2)
    times = sample_times(params, scenes.horizon)
    x, y = motion.positions(times)
    values = np.stack(
        [answer_of_samples(x, y, name, params, times) for name in QUESTIONS]
    )
    slow = motion.oscillates & slides(motion.fastest(), params)
    stays = slow & (motion.highest() < params.preload)
    valid = np.stack([slow, *[stays] * (len(QUESTIONS) - 1)])
    return Answers(np.where(motion.oscillates, values, np.nan), valid)


def _in_time(level: Level, scenes: Scenes) -> Answers:
    """Answers of ``level.model`` over ``level.share`` of the horizon."""
    params, alpha1, alpha2, horizon, workers = scenes
    end = level.share * horizon
    times = sample_times(params, end)
    runs = run_ensemble(
        params,
        alpha1,
        alpha2,
        t_end=end,
        model=level.model,
        times=times,
        tracked=("vx", LARGEST_CONTACT_FORCE, LARGEST_REACH),
        workers=workers,
    )
    values = np.stack([answer_of(runs, question, times) for question in QUESTIONS])
    holds = runs.outcome == Outcome.converged
    if level.model == "A4":
        holds &= slides(runs.max_vx, params)
    reached = runs.sticks + runs.slips + runs.reversals > 0
    return Answers(values, np.broadcast_to(holds, values.shape), reached)
