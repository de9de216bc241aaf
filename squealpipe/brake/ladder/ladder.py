"""Every level of the model ladder over the angle map, judged by A1, and what choosing saves."""

import math

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.ladder.choice import choose_models, run_a1
from squealpipe.brake.ladder.levels import Scenes, answer
from squealpipe.brake.models.refusals import refuse_extensions
from squealpipe.brake.normal_form import NormalForm
from squealpipe.brake.schema.ladder import QUESTIONS, Level, model_ladder_schema
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.systems.processes import cpu_time


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
        points: cells along each angle, at the centres of equal intervals.
    """
    refuse_extensions(
        params,
        "the model ladder",
        "its cheaper levels have neither dashpots nor any friction but Coulomb's",
    )
    horizon = HORIZON * params.time_unit if t_end is None else t_end
    angles = (np.arange(points) + 0.5) * math.pi / points
    alpha1, alpha2 = (
        grid.ravel() for grid in np.meshgrid(angles, angles, indexing="ij")
    )
    # V ≥ 0 from here on: the largest ẋ is the largest speed along the belt
    form = NormalForm.of(params)
    params, (alpha1, alpha2) = form.params, form.angles(alpha1, alpha2)
    scenes = Scenes(params, alpha1, alpha2, horizon, workers)
    short = 1e-3 * horizon
    run_ensemble(
        params, alpha1[:1], alpha2[:1], t_end=short, workers=1
    )  # compile off the clock
    answers = {level: answer(level, scenes) for level in Level}
    truth = answers[Level.a1].values
    reached = np.asarray(answers[Level.a1].belt_reached, dtype=bool)
    ladder_levels = tuple(Level)
    error = np.stack(
        [_errors(answers[level].values, truth) for level in ladder_levels], axis=1
    )
    valid = np.stack([answers[level].valid for level in ladder_levels], axis=1)
    # where the belt is never reached, A1 without stick is A1
    valid[:, ladder_levels.index(Level.a1_no_stick)] &= reached
    cheapest = (valid & (error <= tol)).argmax(axis=1)
    asked = params, alpha1, alpha2, "contact_lost"
    started = (
        cpu_time()
    )  # as choose_model runs it: the answers to all questions at once cost more
    run_a1(np.full(alpha1.shape, np.nan), *asked, horizon, workers=workers)
    always = cpu_time() - started
    chosen = choose_models(*asked, t_end=horizon, workers=workers)
    shape = (points, points)
    return build(
        model_ladder_schema,
        {
            "error": error.reshape(len(QUESTIONS), len(ladder_levels), *shape),
            "cheapest": np.array(ladder_levels)[cheapest].reshape(-1, *shape),
            "chosen": chosen.level.reshape(shape),
            "chosen_wrong": (chosen.value != truth[0]).reshape(shape),
            "always_cpu_time": always,
            "chosen_cpu_time": chosen.cost,
            "belt_reached": reached.reshape(shape),
            "tolerance": tol,
            "outcome": np.full(shape, Outcome.converged),
        },
        {
            "alpha1": angles,
            "alpha2": angles,
            "question": list(QUESTIONS),
            "level": [level.name for level in ladder_levels],
        },
    )


def _errors(values: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Relative errors (question, cell); 0 or 1 for contact lost."""
    error = np.empty(values.shape)
    error[0] = values[0] != truth[0]
    error[1:] = np.abs(values[1:] / truth[1:] - 1.0)
    return np.where(np.isfinite(values), error, np.inf)
