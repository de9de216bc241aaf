"""No more model than a scene needs: which level answers a question, and why.

Below A1 one rule answers, for it alone costs less than A1 does: contact is kept where the linear
motion of A3, with a margin for geometry, stays below y = l_pre (:func:`keeps_contact`). Elsewhere
A1 is the cheapest level whose answer is certain. The rule is not proved; its margins are those that
no cell of a random sample needed.
"""

from __future__ import annotations  # help shows Angle, not its checks

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.ladder.levels import contact_motion
from squealpipe.brake.ladder.questions import answer_of
from squealpipe.brake.models.refusals import extensions
from squealpipe.brake.normal_form import NormalForm
from squealpipe.brake.sampling import sample_times
from squealpipe.brake.schema.ladder import QUESTIONS, Level
from squealpipe.laws.friction import slides
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.systems.processes import cpu_time
from squealpipe.validation import Angle, Positive, Tolerance, checked, one_of


@dataclass(frozen=True)
class LinearMotionRule:
    """Rule by which the linear motion shows that A1, from rest, keeps contact. Each limit is
    wider than random samples needed: none of 89,687 random cells that met the rule was wrong.
    """

    largest_error: float = 0.15
    """Share by which geometry may change the slower mode; the first wrong answer had 0.3."""
    factor: float = 1.5
    """Times the change by geometry that must be left as a margin; 1.1 was needed."""
    floor: float = 0.01
    """Share of l_pre that must be left besides."""
    nearest_whole: float = 0.15
    """Least distance of ω2/ω1 from 1, 2 and 3, where the modes exchange energy."""


rule = LinearMotionRule()


@dataclass(frozen=True)
class Choice:
    """The cheapest trustworthy answer.

    Attributes:
        model: name of the level, of :class:`squealpipe.brake.schema.ladder.Level`.
        value: the answer: truth value, rad/s, N_max/(k3 l_pre), or m.
        checks: what was asked in turn: "linear motion" (:func:`keeps_contact`), "A1".
        cost: CPU time of the rule and of A1 where it ran, s.
    """

    model: str
    value: float | bool
    reason: str
    checks: tuple[str, ...]
    cost: float


@dataclass(frozen=True)
class Choices:
    """Choices of many cells: levels and answers, arrays of one shape, and their CPU time, s."""

    level: np.ndarray
    value: np.ndarray
    cost: float


@checked
def choose_model(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    question: Annotated[str, one_of(QUESTIONS)],
    tol: Tolerance = 1e-12,
    *,
    t_end: Positive | None = None,
) -> Choice:
    """The cheapest level that answers a question as A1 does, and its answer.

    That a level below A1 is right is measured at random parameters, not proved. A1 is run on the
    mirror image with V ≥ 0 and the stiffer spring first: in a chaotic motion, whose numbers
    round-off decides beyond its predictability horizon, that is another sample than a run as given.

    Args:
        alpha1, alpha2: spring angles, rad.
        question: "contact_lost", "frequency" (dominant ω of y), "peak_contact_force"
            (N_max/(k3 l_pre)) or "max_displacement" (largest √(x² + y²)).
        tol: tolerance of A1's integrator where it runs, relative to l_pre.
        t_end: horizon, s; 200 √(m/k1) by default.
    """
    horizon = HORIZON * params.time_unit if t_end is None else t_end
    cells = np.array([alpha1]), np.array([alpha2])
    choices = choose_models(params, *cells, question, t_end=horizon, tol=tol, workers=1)
    level, value = Level(int(choices.level[0])), float(choices.value[0])
    ruled = _has_rule(params, question)
    evidence = (
        "measured, not proved: wrong in none of 89,687 random cells that met the rule"
    )
    return Choice(
        model=level.name,
        value=bool(value) if question == "contact_lost" else value,
        reason="A1 is the cheapest level whose answer is certain here"
        if level == Level.a1
        else f"the linear motion keeps clear of l_pre by a margin ({evidence})",
        checks=("linear motion",) * ruled + ("A1",) * (level == Level.a1),
        cost=choices.cost,
    )


def choose_models(
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    question: str,
    *,
    t_end: float,
    tol: float = 1e-12,
    workers: int | None = None,
) -> Choices:
    """:func:`choose_model` for arrays of cells at once; ``alpha1`` and ``alpha2`` of one shape."""
    started = cpu_time()
    form = NormalForm.of(params)
    alpha1, alpha2 = form.angles(alpha1, alpha2)
    value = np.full(alpha1.shape, np.nan)
    if _has_rule(form.params, question):
        value[keeps_contact(form.params, alpha1, alpha2, t_end)] = 0.0
    level = np.where(np.isnan(value), Level.a1, Level.a3)
    run_a1(
        value, form.params, alpha1, alpha2, question, t_end, tol=tol, workers=workers
    )
    return Choices(level, value, cpu_time() - started)


def _has_rule(params: Parameters, question: str) -> bool:
    """Return whether a rule may answer: it holds neither with dashpots nor with another friction
    law.
    """
    return question == "contact_lost" and not extensions(params)


def keeps_contact(p: Any, alpha1: Any, alpha2: Any, t_end: Any) -> np.ndarray:
    """Return where the linear motion predicts that A1, from rest, keeps contact up to ``t_end``.

    The springs' geometry changes the slower mode by the reach over the shorter spring, times
    (ω2/ω1)². No answer is given where the motion grows, outruns the belt, is near a resonance or
    lies outside the range of the sample.

    Args:
        p: ``Parameters``, or an object with its fields and ``drag``; each may be an array.
    """
    motion = contact_motion(p, alpha1, alpha2)
    reach = motion.farthest()
    ratio = motion.omega[..., 1] / motion.omega[..., 0]
    error = reach / np.minimum(p.length1, p.length2) * ratio * ratio
    keeps = motion.oscillates & slides(motion.fastest(), p) & _in_range(p, t_end)
    keeps &= (np.abs(ratio[..., None] - [1.0, 2.0, 3.0]) > rule.nearest_whole).all(
        axis=-1
    )
    clear = motion.highest() + rule.factor * error * reach < (
        1.0 - rule.floor
    ) * np.asarray(p.preload)
    return np.asarray(keeps & (error < rule.largest_error) & clear)


def _in_range(p: Any, t_end: Any) -> np.ndarray:
    """Return whether parameters and horizon lie within the range of the random sample."""
    mean = 0.5 * (np.asarray(p.k1) + p.k2)
    contact = p.k3 / mean
    return np.asarray(
        (np.minimum(p.length1, p.length2) >= 3.0 * np.asarray(p.preload))
        & (np.maximum(p.k1, p.k2) <= 5.0 * np.minimum(p.k1, p.k2))
        & (contact >= 0.05)
        & (contact <= 5.0)
        & (np.asarray(p.mu) <= 0.8)
        & (t_end <= 400.0 * (1.0 + 1e-12) * np.sqrt(p.mass / mean))
    )


def run_a1(
    value: np.ndarray,
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    question: str,
    t_end: float,
    *,
    tol: float = 1e-12,
    workers: int | None,
) -> None:
    """A1 where nothing cheaper has answered; to the first loss of contact where that is asked."""
    open_ = np.isnan(value)
    if not open_.any():
        return
    times = sample_times(params, t_end)
    run = run_ensemble(
        params,
        alpha1[open_],
        alpha2[open_],
        t_end=t_end,
        tol=tol,
        times=times if question == "frequency" else None,
        stop_at_first_separation=question == "contact_lost",
        workers=workers,
    )
    value[open_] = answer_of(run, question, times)
