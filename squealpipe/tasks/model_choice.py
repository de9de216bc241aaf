"""No more model than a scene needs: which level answers a question within a tolerance, and why.

Three ways to an answer, cheapest first. Closed form: the linear motion in contact is bounded for
all times by its two modes; if the bound keeps clear of l_pre by more than the springs' geometry
can shift it, contact is never lost (or surely lost), without a run. Where the first integral of
A4 is definite, it bounds the contact force, contact lost or not. Short run: A1 over a part of
the horizon; a mass that has kept its distance from separation that long keeps contact. Else A1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.springs import geometry, linear_stiffness, stiffness_determinant
from squealpipe.methods.modal_bounds import ModalMotion, modal_motion
from squealpipe.models import a3, a4
from squealpipe.parameters import Parameters
from squealpipe.schema.comparison import QUESTIONS, Level
from squealpipe.tasks.answers import answer_of, answer_of_samples, sample_times
from squealpipe.tasks.ensemble import run_ensemble

DEFAULT_HORIZON = 200.0
"""Horizon unless told otherwise, √(m/k1)."""
GEOMETRY_FACTOR = 0.75
"""Share of (k/(m ω1²)) r/L by which the springs' geometry may move the linear motion.

With it none of 20,000 random cells of the baseline is decided wrongly by the bounds; 0.5 is
too little (80 wrong). tests/tasks/test_model_choice.py repeats the check.
"""
LEAST_MARGIN = 0.02
"""Distance from l_pre below which no bound decides: both modes need time to meet."""
LEAST_FORCE = 0.03
STAGES = ((0.1, 0.10), (0.2, 0.04), (0.4, 0.01))
"""(share of the horizon, contact force over k3 l_pre that must be left) to trust in contact."""
SLOW_PERIODS = 1.5
"""Periods of the slow mode that a run must have seen before it is trusted."""
SHORT_RUN = {"frequency": 0.25, "peak_contact_force": 0.25, "max_displacement": 0.5}
"""Share of the horizon that answers, where at least LEAST_FORCE is left; the largest displacement
needs the longest, for both modes must come to meet."""
GEOMETRY_SHARE = 0.5
"""Share of the tolerance that the geometry may take where the linear motion itself answers."""
UNEQUAL = 1.5
"""Ratio of modal amplitudes from which one mode is said to dominate."""


class Check(NamedTuple):
    """One thing that was looked at before a level was trusted."""

    name: str
    passed: bool
    detail: str


@dataclass(frozen=True)
class Choice:
    """The cheapest trustworthy answer.

    Attributes:
        model: name of the level, of :class:`squealpipe.schema.comparison.Level`.
        value: the answer: truth value, rad/s, N_max/(k3 l_pre), or m.
        reason: why this level.
        checks: what was looked at.
        cost: time integrated by A1 over the horizon; 0 where no run was needed.
    """

    model: str
    value: float | bool
    reason: str
    checks: tuple[Check, ...]
    cost: float


@dataclass(frozen=True)
class Choices:
    """Choices of many cells; all arrays of one shape.

    Attributes:
        level: :class:`squealpipe.schema.comparison.Level`.
        value: answers.
        integrated: time integrated by A1, s.
        motion: the linear motion that was looked at.
        shift: by how much geometry may move it, over l_pre.
        margin: least contact force left in the longest short run, over k3 l_pre; NaN without.
        reach: how far and fast the first integral of A4 lets the mass go; ∞ where it does not say.
    """

    level: np.ndarray
    value: np.ndarray
    integrated: np.ndarray
    motion: ModalMotion
    shift: np.ndarray
    margin: np.ndarray
    reach: a4.ReachFromRest


def choose_model(
    params: Parameters,
    alpha1: float,
    alpha2: float,
    question: str,
    tol: float,
    *,
    t_end: float | None = None,
) -> Choice:
    """The cheapest level that answers a question within a tolerance of A1, and its answer.

    Args:
        params: physical parameters.
        alpha1, alpha2: spring angles, rad.
        question: "contact_lost", "frequency" (dominant ω of y), "peak_contact_force"
            (N_max/(k3 l_pre)) or "max_displacement" (largest √(x² + y²)).
        tol: relative error that is allowed; contact lost is right or wrong.
        t_end: horizon, s; 200 √(m/k1) by default.

    Raises:
        ValueError: the question is unknown, or tol is not positive.
    """
    horizon = DEFAULT_HORIZON * params.time_unit if t_end is None else t_end
    cells = (np.array([float(alpha1)]), np.array([float(alpha2)]))
    found = choose_models(params, *cells, question, tol, t_end=horizon, workers=1)
    level = Level(int(found.level[0]))
    value = float(found.value[0])
    return Choice(
        model=level.name,
        value=bool(value) if question == "contact_lost" else value,
        reason=_reason(level, question),
        checks=_checks(found, params, question, tol),
        cost=float(found.integrated[0]) / horizon,
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
    if question not in QUESTIONS:
        raise ValueError(f"question = {question!r}: one of {', '.join(QUESTIONS)} is needed")
    if not (math.isfinite(tol) and tol > 0):
        raise ValueError(f"tol = {tol!r}: a finite number above 0 is needed")
    alpha1, alpha2 = np.asarray(alpha1, float), np.asarray(alpha2, float)
    motion = contact_motion(params, alpha1, alpha2)
    shift = geometry_shift(motion, params)
    keeps, loses = decided_by_bounds(motion, shift, params)

    choices = Choices(
        level=np.full(alpha1.shape, Level.a1, dtype=int),
        value=np.full(alpha1.shape, np.nan),
        integrated=np.zeros(alpha1.shape),
        motion=motion,
        shift=shift,
        margin=np.full(alpha1.shape, np.nan),
        reach=first_integral_reach(params, alpha1, alpha2),
    )
    stays = motion.oscillates & (motion.highest() / params.preload - 1.0 <= shift)
    runs = _Runs(params, alpha1, alpha2, t_end, workers)
    if question == "contact_lost":
        settled = keeps | loses
        choices.level[settled], choices.value[settled] = Level.closed_form, loses[settled]
        _run_until_decided(choices, ~settled, stays, runs)
    else:
        if question == "peak_contact_force":
            _answer_by_first_integral(choices, tol, runs)
        _answer_in_contact(choices, keeps & (shift <= GEOMETRY_SHARE * tol), question, runs)
        # what a mass does after it has lost contact, no part of the horizon tells
        _run_once(choices, stays & ~loses, question, SHORT_RUN[question], runs)
        _run_once(choices, np.ones_like(stays), question, 1.0, runs)
    return choices


class _Runs(NamedTuple):
    """What all runs of a choice share."""

    params: Parameters
    alpha1: np.ndarray
    alpha2: np.ndarray
    t_end: float
    workers: int | None


def _run_until_decided(choices: Choices, open_: np.ndarray, stays: np.ndarray, runs: _Runs) -> None:
    """A1 stage by stage, each going on from the last, until contact is lost or safe."""
    state = np.zeros((*open_.shape, 4))
    elapsed = 0.0
    for share, least in (*STAGES, (1.0, -math.inf)):
        if not open_.any():
            return
        run = run_ensemble(
            runs.params, runs.alpha1[open_], runs.alpha2[open_], t_end=share * runs.t_end - elapsed,
            initial_state=state[open_], stop_at_first_separation=True, workers=runs.workers,
        )  # fmt: skip
        elapsed = share * runs.t_end
        lost = run.separations > 0
        state[open_] = run.final_state
        choices.integrated[open_] += run.time
        choices.margin[open_] = np.fmin(choices.margin[open_], run.lowest_contact_force)
        seen = elapsed * choices.motion.omega[open_, 0] >= 2.0 * math.pi * SLOW_PERIODS
        safe = (choices.margin[open_] >= least) & (stays[open_] & seen | (share == 1.0))
        cells = np.flatnonzero(open_)[lost | safe]
        choices.value.flat[cells] = lost[lost | safe]
        choices.level.flat[cells] = Level.a1 if share == 1.0 else Level.a1_short
        open_.flat[cells] = False


def _run_once(
    choices: Choices, where: np.ndarray, question: str, share: float, runs: _Runs
) -> None:
    """A1 from rest over a share of the horizon; a part is trusted only far from separation."""
    open_ = where & np.isnan(choices.value)
    if not open_.any():
        return
    end = share * runs.t_end
    times = sample_times(runs.params, end)
    run = run_ensemble(
        runs.params, runs.alpha1[open_], runs.alpha2[open_], t_end=end,
        times=times if question == "frequency" else None,
        stop_at_first_separation=share < 1.0, workers=runs.workers,
    )  # fmt: skip
    choices.integrated[open_] += run.time
    answers = answer_of(run, question, times)
    trusted = np.ones(len(answers), dtype=bool)
    if share < 1.0:
        choices.margin[open_] = np.where(run.separations > 0, 0.0, run.lowest_contact_force)
        trusted = choices.margin[open_] >= LEAST_FORCE
    cells = np.flatnonzero(open_)[trusted]
    choices.value.flat[cells] = answers[trusted]
    choices.level.flat[cells] = Level.a1_short if share < 1.0 else Level.a1


def contact_motion(params: Parameters, alpha1: Any, alpha2: Any) -> ModalMotion:
    """The linear motion from rest that never leaves contact (A3, Eqs. (6), (7))."""
    g = geometry(np.asarray(alpha1, float), np.asarray(alpha2, float))
    stiffness = linear_stiffness(params, g)
    determinant = stiffness_determinant(params, g)
    invariants = a4.spectrum(stiffness, determinant, k3=params.k3, mu=params.drag, mass=params.mass)
    x, y, _ = a3.static_state(
        stiffness, determinant, k3=params.k3, mu=params.drag, actuation=params.k3 * params.preload
    )
    a11, a12, a21, a22 = (
        value / params.mass for value in a4.contact_matrix(stiffness, params.k3, params.drag)
    )
    first, second = a4.natural_frequencies_squared(invariants)
    return modal_motion((a11, a12, a21, a22), (first, second), (x, y))


def geometry_shift(motion: ModalMotion, params: Parameters) -> np.ndarray:
    """By how much the exact geometry may move the linear motion, over l_pre.

    The springs' force deviates from K r by about k r²/L; against the stiffness m ω1² of the soft
    mode that is a displacement of (k/(m ω1²)) (r/L) r.
    """
    softness = max(params.k1, params.k2) / (params.mass * motion.omega[..., 0] ** 2)
    reach = motion.farthest() / min(params.length1, params.length2)
    return np.asarray(GEOMETRY_FACTOR * softness * reach)


def decided_by_bounds(
    motion: ModalMotion, shift: np.ndarray, params: Parameters
) -> tuple[np.ndarray, np.ndarray]:
    """Cells that surely keep contact, and cells that surely lose it."""
    trusted = motion.oscillates & (motion.fastest() < params.belt_speed)
    gap = 1.0 - motion.highest() / params.preload
    needed = np.maximum(shift, LEAST_MARGIN)
    return trusted & (gap > needed), trusted & (-gap > needed)


def _answer_in_contact(choices: Choices, cells: np.ndarray, question: str, runs: _Runs) -> None:
    """Level and value of the cells where the linear motion itself answers."""
    if not cells.any():
        return
    motion = choices.motion
    if question == "frequency":
        # modes of nearly equal size: which one dominates hangs on what the linear model drops
        size = np.abs(motion.y_mode)
        clear = cells & (size.max(axis=-1) > UNEQUAL * size.min(axis=-1))
        dominant = np.take_along_axis(motion.omega, size.argmax(axis=-1)[..., None], axis=-1)
        choices.value[clear], choices.level[clear] = dominant[..., 0][clear], Level.closed_form
        return
    times = sample_times(runs.params, runs.t_end)
    x, y = ModalMotion(*(field[cells] for field in motion)).positions(times)
    choices.value[cells] = answer_of_samples(x, y, question, runs.params, times)
    choices.level[cells] = Level.a3_in_contact


def _answer_by_first_integral(choices: Choices, tol: float, runs: _Runs) -> None:
    """The force of the start, where the first integral of A4 lets none be larger.

    The springs' geometry changes their force by the share r/L, which must be within the
    tolerance for the largest r.
    """
    params = runs.params
    within = choices.reach.distance <= tol * min(params.length1, params.length2)
    cells = within & (choices.reach.speed < abs(params.belt_speed))
    choices.value[cells], choices.level[cells] = 1.0, Level.closed_form


def first_integral_reach(params: Parameters, alpha1: Any, alpha2: Any) -> a4.ReachFromRest:
    """Bounds of A4 from rest over arrays of angles."""
    stiffness = linear_stiffness(params, geometry(np.asarray(alpha1), np.asarray(alpha2)))
    return a4.reach_from_rest(stiffness, params.drag, params)


def _reason(level: Level, question: str) -> str:
    if level == Level.closed_form and question == "contact_lost":
        return "the modal bound is clear of l_pre by more than the springs' geometry can shift it"
    if level == Level.closed_form and question == "peak_contact_force":
        return "the first integral of A4 allows no larger force than that of the start"
    if level == Level.closed_form:
        return "contact is kept for all times and one linear mode dominates"
    if level == Level.a3_in_contact:
        return "contact is kept for all times and the geometry's share is within the tolerance"
    if level == Level.a1_short:
        return "a part of the horizon decides: contact is lost there, or stays far from lost"
    return "no cheaper level keeps its own assumptions within the tolerance"


def _checks(found: Choices, params: Parameters, question: str, tol: float) -> tuple[Check, ...]:
    motion, shift, margin = found.motion, float(found.shift[0]), float(found.margin[0])
    highest = float(motion.highest()[0]) / params.preload
    fastest = float(motion.fastest()[0])
    checks = [
        Check("linear motion oscillates", bool(motion.oscillates[0]), "both ω² real and positive"),
        Check(
            "slower than the belt",
            fastest < params.belt_speed,
            f"|x'| ≤ {fastest:.3g}, V = {params.belt_speed:.3g}",
        ),
        Check(
            "contact decided for all times",
            abs(1.0 - highest) > max(shift, LEAST_MARGIN),
            f"linear bound y/l_pre ≤ {highest:.3g}, geometry ± {shift:.2g}",
        ),
    ]
    if question != "contact_lost":
        allowed = GEOMETRY_SHARE * tol
        checks.append(
            Check("geometry within tolerance", shift <= allowed, f"{shift:.2g} ≤ {allowed:.2g}?")
        )
    if question == "peak_contact_force":
        distance, allowed = (
            float(found.reach.distance[0]),
            tol * min(params.length1, params.length2),
        )
        checks.append(
            Check(
                "first integral bounds the motion",
                distance <= allowed,
                f"√(x² + y²) ≤ {distance:.3g}, {allowed:.3g} allowed",
            )
        )
    if math.isfinite(margin):
        checks.append(
            Check("contact force left in a short run", margin >= LEAST_FORCE, f"{margin:.2g}")
        )
    return tuple(checks)
