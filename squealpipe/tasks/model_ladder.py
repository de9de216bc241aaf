"""Every level of the model ladder over the angle map, judged by A1, and what choosing saves."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.methods.modal_trajectory import trajectory_from_rest
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.comparison import MODEL_LADDER, QUESTIONS, Level
from squealpipe.tasks.a4_system import scaled_system
from squealpipe.tasks.answers import answer_of, answer_of_samples, sample_times
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.model_choice import SHORT_RUN, choose_models, contact_motion

LEVELS = tuple(level.name for level in Level)
_SHORT = max(SHORT_RUN.values())
_PARTIAL = {
    Level.closed_form: 0.0,
    Level.a3_in_contact: 0.0,
    Level.a4_exact: 0.0,
    Level.a1_short: _SHORT,
}
_SHARES = np.array([_PARTIAL.get(level, 1.0) for level in Level])
"""Share of the horizon that each level integrates in time."""


class _Answers(NamedTuple):
    """Answers (question, …) of one level, where its own assumptions hold, and what they cost."""

    values: np.ndarray
    valid: np.ndarray
    seconds: float
    time: float = 0.0


def model_ladder(
    params: Parameters,
    points: int,
    tol: float,
    *,
    t_end: float | None = None,
    workers: int | None = None,
) -> xr.Dataset:
    """Dataset ``model_ladder`` over both angles from 0 to π.

    Args:
        params: physical parameters.
        points: cells along each angle, at the centres of equal intervals.
        tol: relative error that is allowed.
        t_end: horizon, s; 200 √(m/k1) by default.
        workers: processes; None takes all cores.
    """
    horizon = 200.0 * params.time_unit if t_end is None else t_end
    angles = (np.arange(points) + 0.5) * math.pi / points
    alpha1, alpha2 = (grid.ravel() for grid in np.meshgrid(angles, angles, indexing="ij"))
    levels = _levels(params, alpha1, alpha2, horizon, workers)
    run_ensemble(params, alpha1[:1], alpha2[:1], t_end=1.0, workers=1)  # compile off the clock
    found = {level: run() for level, run in levels.items()}
    truth = found[Level.a1].values
    error = np.stack([_errors(found[level].values, truth) for level in Level], axis=1)
    valid = np.stack([found[level].valid for level in Level], axis=1)
    cheapest = (valid & (error <= tol)).argmax(axis=1)
    chosen = [
        _chosen(params, alpha1, alpha2, question, tol, horizon, workers, found[Level.a1], best)
        for question, best in zip(QUESTIONS, cheapest, strict=True)
    ]
    shape = (points, points)
    return build(
        MODEL_LADDER,
        {
            "error": error.reshape(len(QUESTIONS), len(LEVELS), *shape),
            "cheapest": cheapest.reshape(-1, *shape),
            "chosen": np.stack([entry.level for entry in chosen]).reshape(-1, *shape),
            "chosen_error": np.stack([entry.error for entry in chosen]).reshape(-1, *shape),
            "chosen_time": [entry.time for entry in chosen],
            "always_time": [entry.always_time for entry in chosen],
            "hindsight_time": [entry.hindsight_time for entry in chosen],
            "level_wall_time": [found[level].seconds for level in Level],
            "always_wall_time": [entry.always_seconds for entry in chosen],
            "chosen_wall_time": [entry.seconds for entry in chosen],
            "tolerance": tol,
            "outcome": np.full(shape, Outcome.converged),
        },
        {"alpha1": angles, "alpha2": angles, "question": list(QUESTIONS), "level": list(LEVELS)},
    )


def _errors(values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Relative errors (question, cell); 0 or 1 for contact lost."""
    error = np.empty(values.shape)
    error[0] = values[0] != truth[0]
    error[1:] = np.abs(values[1:] / truth[1:] - 1.0)
    return np.where(np.isfinite(values), error, np.inf)


class _Chosen(NamedTuple):
    level: np.ndarray
    error: np.ndarray
    time: float
    always_time: float
    hindsight_time: float
    seconds: float
    always_seconds: float


def _chosen(
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    question: str,
    tol: float,
    horizon: float,
    workers: int | None,
    always: _Answers,
    cheapest: np.ndarray,
) -> _Chosen:
    """What choose_model takes, its error, and its cost beside that of always A1."""
    needed = np.full(cheapest.shape, horizon)
    truth = always.values[QUESTIONS.index(question)]
    always_time, always_seconds = always.time, always.seconds
    if question == "contact_lost":
        started = time.perf_counter()
        stopped = run_ensemble(
            params, alpha1, alpha2, t_end=horizon, stop_at_first_separation=True, workers=workers
        )
        needed = stopped.time
        always_time = float(needed.sum())
        always_seconds = time.perf_counter() - started
    started = time.perf_counter()
    choices = choose_models(params, alpha1, alpha2, question, tol, t_end=horizon, workers=workers)
    seconds = time.perf_counter() - started
    wrong = choices.value != truth
    error = wrong.astype(float) if question == "contact_lost" else abs(choices.value / truth - 1.0)
    return _Chosen(
        level=choices.level,
        error=error,
        time=float(choices.integrated.sum()),
        always_time=always_time,
        hindsight_time=float((needed * _SHARES[cheapest]).sum()),
        seconds=seconds,
        always_seconds=always_seconds,
    )


def _levels(
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    horizon: float,
    workers: int | None,
) -> dict[Level, Callable[[], _Answers]]:
    def in_time(model: str, share: float = 1.0) -> Callable[[], _Answers]:
        def run() -> _Answers:
            started = time.perf_counter()
            times = sample_times(params, share * horizon)
            found = run_ensemble(
                params, alpha1, alpha2, t_end=share * horizon, model=model, times=times,
                workers=workers,
            )  # fmt: skip
            values = np.stack([answer_of(found, question, times) for question in QUESTIONS])
            holds = np.isin(found.outcome, (Outcome.converged,))
            if model == "A4":
                holds &= found.max_vx < params.belt_speed
            valid = np.broadcast_to(holds, values.shape)
            seconds = time.perf_counter() - started
            return _Answers(values, valid, seconds, float(found.time.sum()))

        return run

    return {
        Level.closed_form: lambda: _closed_form(params, alpha1, alpha2),
        Level.a3_in_contact: lambda: _a3(params, alpha1, alpha2, horizon),
        Level.a4_exact: lambda: _a4_exact(params, alpha1, alpha2, horizon),
        Level.a4_in_time: in_time("A4"),
        Level.a1_linear_springs: in_time("A1-linear-springs"),
        Level.a1_no_stick: in_time("A1-no-stick"),
        Level.a1_short: in_time("A1", _SHORT),
        Level.a1: in_time("A1"),
    }


def _closed_form(params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray) -> _Answers:
    """Bounds of the linear motion for all times, and its dominant mode."""
    started = time.perf_counter()
    motion = contact_motion(params, alpha1, alpha2)
    dominant = np.abs(motion.y_mode).argmax(axis=-1)[..., None]
    values = np.stack(
        [
            (motion.highest() > params.preload).astype(float),
            np.take_along_axis(motion.omega, dominant, axis=-1)[..., 0],
            1.0 - motion.lowest() / params.preload,
            motion.farthest(),
        ]
    )
    return _Answers(values, _linear_validity(motion, params), time.perf_counter() - started)


def _a3(params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray, horizon: float) -> _Answers:
    """The linear motion in contact, sampled over the horizon."""
    started = time.perf_counter()
    motion = contact_motion(params, alpha1, alpha2)
    times = sample_times(params, horizon)
    x, y = motion.positions(times)
    values = np.stack([answer_of_samples(x, y, name, params, times) for name in QUESTIONS])
    return _Answers(values, _linear_validity(motion, params), time.perf_counter() - started)


def _linear_validity(motion: Any, params: Parameters) -> np.ndarray:
    """Only contact lost may be asked of a motion that leaves contact."""
    slides = motion.oscillates & (motion.fastest() < params.belt_speed)
    stays = slides & (motion.highest() < params.preload)
    return np.stack([slides, *[stays] * (len(QUESTIONS) - 1)])


def _a4_exact(
    params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray, horizon: float
) -> _Answers:
    """A4 by closed-form flow from switch to switch, cell by cell."""
    times = sample_times(params, horizon)
    states = np.empty((len(times), 4))
    values = np.full((len(QUESTIONS), len(alpha1)), np.nan)
    valid = np.zeros(values.shape, dtype=bool)
    trajectory_from_rest(
        scaled_system(params, 1.0, 1.0).system.rows, times[:2], states
    )  # compile off the clock
    started = time.perf_counter()
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
        valid[:, cell] = speed < params.belt_speed
    return _Answers(values, valid, time.perf_counter() - started)
