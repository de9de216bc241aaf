"""No more model than a scene needs: which level answers a question within a tolerance, and why.

Only rules that cost less than A1 itself are tried. Both are closed forms of linear levels, trusted
where A1's geometry changes them little:

- *Linear motion.* Contact is kept where the two modes of A3, with a margin for geometry, stay
  below y = l_pre (:func:`linear_motion`). The frequency is that of a dominant mode; the largest
  force lies between that of the start and the bound.
- *First integral.* Where that of A4 is definite the mass never presses harder than at the start,
  contact lost or not (:func:`first_integral_error`).

Elsewhere A1 is the cheapest level whose answer is certain. No rule is proved; the margins are those
that no cell of a random sample (:data:`SAMPLE`) needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from squealpipe.laws.friction import slides
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.methods.modal_bounds import ModalMotion
from squealpipe.methods.processes import cpu_time
from squealpipe.models import a4
from squealpipe.models.refusals import without_extensions
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.ladder.levels import contact_motion
from squealpipe.tasks.ladder.questions import answer_of, dominant_frequency
from squealpipe.tasks.normal_form import NormalForm
from squealpipe.tasks.sampling import sample_times
from squealpipe.validation import Angle, Positive, checked, one_of

SAMPLE = "measured, not proved: wrong in none of 89,687 random cells that met the rule"
LARGEST_ERROR = 0.15
"""Share by which geometry may change the slower mode; the first wrong answer had 0.3."""
FACTOR = 1.5
"""Times the change by geometry that must be left; 1.1 was needed."""
FLOOR = 0.01
"""Share of l_pre that must be left besides."""
LARGEST_TURN = 0.05
"""Reach over the shorter spring up to which the first integral of A4 is trusted in A1, or a
:data:`RESONANT` part of it."""
RESONANT = 5.0
"""How much more than far from resonance is assumed up to ω2 = 2 ω1 and a little more."""
NEAREST_WHOLE = 0.15
"""Least distance of ω2/ω1 from 1, 2 and 3, where the modes exchange energy."""
UNEQUAL = 1.5
"""Ratio of modal amplitudes from which one mode is said to dominate."""
LEAST_PERIODS = 4.0
"""Periods of the dominant mode that the horizon must show."""
LINE_WIDTH = 4.0 * math.pi
"""Half the width of a spectral line under a Hann window, over one through the length of the run."""


@dataclass(frozen=True)
class Choice:
    """The cheapest trustworthy answer.

    Attributes:
        model: name of the level, of :class:`squealpipe.schema.ladder.Level`.
        value: the answer: truth value, rad/s, N_max/(k3 l_pre), or m.
        reason: why this level.
        cost: CPU time of the rules and of A1 where it ran, s.
    """

    model: str
    value: float | bool
    reason: str
    cost: float


class Linear(NamedTuple):
    """The linear motion in contact, and how far A1 may be from it; arrays of the cells' shape.

    Attributes:
        motion: from rest, of A3.
        error: share by which the springs' geometry changes the slower mode: the reach over the
            shorter spring, times (ω2/ω1)²; ∞ where the motion grows, outruns the belt, is near a
            resonance or lies outside the range of the sample.
        margin: :data:`FACTOR` times that share of the reach, m.
        keeps: contact is never lost.
    """

    motion: ModalMotion
    error: np.ndarray
    margin: np.ndarray
    keeps: np.ndarray


@dataclass(frozen=True)
class Choices:
    """Choices of many cells; arrays of one shape.

    Attributes:
        level: :class:`squealpipe.schema.ladder.Level`.
        value: answers.
        linear: what the linear motion says.
        first_integral: relative error of the first integral's bound on the force; ∞ where unknown.
        cost: CPU time of all cells together, s.
    """

    level: np.ndarray
    value: np.ndarray
    linear: Linear
    first_integral: np.ndarray
    cost: float


@checked
def choose_model(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    question: Annotated[str, one_of(QUESTIONS)],
    tol: Positive,
    *,
    t_end: Positive | None = None,
) -> Choice:
    """The cheapest level that answers a question within a tolerance of A1, and its answer.

    A level below A1 is taken by rules that cost less than A1 alone; that they keep to the tolerance
    is measured at random parameters, not proved. A1 is run on the mirror image with V ≥ 0 and the
    stiffer spring first: in a chaotic motion, whose numbers round-off decides beyond its
    predictability horizon, that is another sample than a run as given.

    Args:
        params: physical parameters.
        alpha1, alpha2: spring angles, rad.
        question: "contact_lost", "frequency" (dominant ω of y), "peak_contact_force"
            (N_max/(k3 l_pre)) or "max_displacement" (largest √(x² + y²)).
        tol: relative error that is allowed; contact lost is right or wrong.
        t_end: horizon, s; 200 √(m/k1) by default.

    Raises:
        ValueError: the question is unknown or tol is not positive.
    """
    horizon = HORIZON * params.time_unit if t_end is None else t_end
    cells = np.array([alpha1]), np.array([alpha2])
    found = choose_models(params, *cells, question, tol, t_end=horizon, workers=1)
    level = Level(int(found.level[0]))
    value = float(found.value[0])
    return Choice(
        model=level.name,
        value=bool(value) if question == "contact_lost" else value,
        reason=_reason(found, level, question),
        cost=found.cost,
    )


def choose_models(
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    question: str,
    tol: float,
    *,
    t_end: float,
    workers: int | None = None,
) -> Choices:
    """:func:`choose_model` for arrays of cells at once; ``alpha1`` and ``alpha2`` of one shape."""
    started = cpu_time()
    form = NormalForm.of(params)
    alpha1, alpha2 = form.angles(alpha1, alpha2)
    coulomb = without_extensions(form.params)
    linear = linear_motion(coulomb, alpha1, alpha2, t_end)
    bound = np.full(alpha1.shape, np.inf)
    if question == "peak_contact_force":
        bound = first_integral_error(coulomb, alpha1, alpha2, linear)
    value = np.full(alpha1.shape, np.nan)
    if coulomb is form.params:  # neither rule holds with dashpots or another friction law
        _answer_below_a1(value, linear, bound, question, tol, coulomb, t_end)
    level = np.where(np.isnan(value), Level.a1, Level.a3)
    run_a1(value, form.params, alpha1, alpha2, question, t_end, workers)
    return Choices(level, value, linear, bound, cpu_time() - started)


def linear_motion(p: Any, alpha1: Any, alpha2: Any, t_end: Any) -> Linear:
    """What the linear motion says of cells up to ``t_end``, s.

    Args:
        p: ``Parameters``, or an object with its fields and ``drag``; each may be an array.
        alpha1, alpha2: angles, rad, of one shape.
        t_end: horizon, s.
    """
    motion = contact_motion(p, alpha1, alpha2)
    reach = motion.farthest()
    ratio = motion.omega[..., 1] / motion.omega[..., 0]
    error = reach / np.minimum(p.length1, p.length2) * ratio * ratio
    trusted = motion.oscillates & slides(motion.fastest(), p) & _in_range(p, t_end)
    trusted &= (np.abs(ratio[..., None] - [1.0, 2.0, 3.0]) > NEAREST_WHOLE).all(axis=-1)
    margin = FACTOR * error * reach
    preload = np.asarray(p.preload)
    keeps = (
        trusted & (error < LARGEST_ERROR) & (motion.highest() + margin < (1.0 - FLOOR) * preload)
    )
    return Linear(motion, np.where(trusted, error, np.inf), margin, keeps)


def first_integral_error(p: Any, alpha1: Any, alpha2: Any, linear: Linear) -> np.ndarray:
    """By how much the force may exceed what A4's first integral allows, relative; ∞ for unknown.

    The springs' geometry changes their force by the share r/L for the largest r. The changes add
    up where they make the sliding state unstable, or the modes exchange energy: there nothing, and
    :data:`RESONANT` times as much, is assumed.
    """
    stiffness = linear_stiffness(p, geometry(np.asarray(alpha1), np.asarray(alpha2)))
    reach = a4.reach_from_rest(stiffness, p.drag, p)
    turn = reach.distance / np.minimum(p.length1, p.length2)
    motion = linear.motion
    far = motion.omega[..., 1] > (2.0 + NEAREST_WHOLE) * motion.omega[..., 0]
    error = np.where(far, turn, RESONANT * turn)
    known = motion.oscillates & slides(reach.speed, p) & (error <= LARGEST_TURN)
    return np.where(known, error, np.inf)


def _in_range(p: Any, t_end: Any) -> np.ndarray:
    """Whether parameters and horizon lie within the range of the random sample."""
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


def _answer_below_a1(
    value: np.ndarray,
    linear: Linear,
    bound: np.ndarray,
    question: str,
    tol: float,
    params: Parameters,
    t_end: float,
) -> None:
    """Fill in what the rules answer."""
    if question == "contact_lost":
        value[linear.keeps] = 0.0
    elif question == "frequency":
        cells = linear.keeps & dominates(linear.motion, t_end) & (linear.error <= tol)
        if cells.any():  # seen through the same window as A1's, which may show few periods
            times = sample_times(params, t_end)
            _, y = _of_cells(linear.motion, cells).positions(times)
            value[cells] = dominant_frequency(y, times)
    elif question == "peak_contact_force":
        upper = largest_force(linear, params.preload)
        cells = linear.keeps & (upper - 1.0 <= tol * (upper + 1.0))
        value[cells] = 2.0 * upper[cells] / (1.0 + upper[cells])  # as far from 1 as from the bound
        value[~cells & (bound <= tol)] = 1.0


def run_a1(
    value: np.ndarray,
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    question: str,
    t_end: float,
    workers: int | None,
) -> None:
    """A1 where nothing cheaper has answered; to the first loss of contact where that is asked."""
    open_ = np.isnan(value)
    if not open_.any():
        return
    times = sample_times(params, t_end)
    run = run_ensemble(
        params, alpha1[open_], alpha2[open_], t_end=t_end,
        times=times if question == "frequency" else None,
        stop_at_first_separation=question == "contact_lost", workers=workers,
    )  # fmt: skip
    value[open_] = answer_of(run, question, times)


def dominates(motion: ModalMotion, t_end: float) -> np.ndarray:
    """Whether one mode clearly dominates y, and ``t_end`` shows its periods and both lines."""
    size = np.abs(motion.y_mode)
    omega = np.take_along_axis(motion.omega, size.argmax(axis=-1)[..., None], axis=-1)[..., 0]
    clear = size.max(axis=-1) > UNEQUAL * size.min(axis=-1)
    clear &= omega * t_end > 2.0 * math.pi * LEAST_PERIODS
    return np.asarray(clear & ((motion.omega[..., 1] - motion.omega[..., 0]) * t_end > LINE_WIDTH))


def largest_force(linear: Linear, preload: Any) -> np.ndarray:
    """Bound on N/(k3 l_pre) where contact is kept; not less than that of the start."""
    return np.asarray(np.maximum(1.0, 1.0 + (linear.margin - linear.motion.lowest()) / preload))


def _of_cells(motion: ModalMotion, cells: np.ndarray) -> ModalMotion:
    return ModalMotion(*(field[cells] for field in motion))


def _reason(found: Choices, level: Level, question: str) -> str:
    if level == Level.a1:
        return "A1 is the cheapest level whose answer is certain here"
    if question == "contact_lost":
        return f"the linear motion keeps clear of l_pre by a margin ({SAMPLE})"
    if question == "frequency":
        return f"contact is never lost and one linear mode dominates ({SAMPLE})"
    if found.value[0] == 1.0:
        return f"the first integral of A4 allows no larger force than that of the start ({SAMPLE})"
    return f"between the force of the start and a bound that is not exceeded ({SAMPLE})"
