"""No more model than a scene needs: which level answers a question within a tolerance, and why.

Three ways to an answer, cheapest first. Closed form: a bound on the motion in contact certifies
that contact is never lost (:mod:`squealpipe.tasks.ladder.certificate`), without a run; where the
first integral of A4 is definite, it bounds the contact force, contact lost or not. Short run: A1
over a part of the horizon, where contact is kept with a margin; not for whether it is lost, which
no part of the horizon tells. Else A1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squealpipe.arrays import real_array, real_number
from squealpipe.laws.friction import slides
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.methods.modal_bounds import ModalMotion, modal_motion
from squealpipe.models import a3, a4
from squealpipe.models.contact_system import contact_system
from squealpipe.models.refusals import without_extensions
from squealpipe.parameters import Parameters
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.ladder.certificate import Certificate, contact_certificate
from squealpipe.tasks.ladder.questions import answer_of, answer_of_samples, sample_times
from squealpipe.tasks.normal_form import NormalForm

DEFAULT_HORIZON = 200.0
"""Horizon unless told otherwise, √(m/k1)."""
LEAST_FORCE = 0.03
"""Contact force, over k3 l_pre, that a short run must leave to be trusted."""
SHORT_RUN = {"frequency": 0.25, "peak_contact_force": 0.25, "max_displacement": 0.5}
"""Share of the horizon that answers, where at least LEAST_FORCE is left; the largest displacement
needs the longest, for both modes must come to meet."""
GEOMETRY_SHARE = 0.5
"""Share of the tolerance that the geometry may take where the linear motion itself answers."""
UNEQUAL = 2.0
"""Ratio of modal amplitudes from which one mode is said to dominate."""
LEAST_PERIODS = 4.0
"""Periods of the slower mode that a short run must show."""
LINE_WIDTH = 4.0 * math.pi
"""Half the width of a spectral line under a Hann window, over one through the length of the run."""


class Check(NamedTuple):
    """One thing that was looked at before a level was trusted."""

    name: str
    passed: bool
    detail: str


@dataclass(frozen=True)
class Choice:
    """The cheapest trustworthy answer.

    Attributes:
        model: name of the level, of :class:`squealpipe.schema.ladder.Level`.
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
        level: :class:`squealpipe.schema.ladder.Level`.
        value: answers.
        integrated: time integrated by A1, s.
        motion: the linear motion that was looked at.
        shift: by how much geometry moves it, relative.
        certificate: what is known of contact without a run.
        margin: least contact force left in the longest short run, over k3 l_pre; NaN without.
        reach: how far and fast the first integral of A4 lets the mass go; ∞ where it does not say.
    """

    level: np.ndarray
    value: np.ndarray
    integrated: np.ndarray
    motion: ModalMotion
    shift: np.ndarray
    certificate: Certificate
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
        ValueError: the question is unknown or tol is not positive.
    """
    horizon = DEFAULT_HORIZON * params.time_unit if t_end is None else t_end
    horizon = real_number("t_end", horizon, above=0.0)
    cells = (
        np.array([real_number("alpha1", alpha1)]),
        np.array([real_number("alpha2", alpha2)]),
    )
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
    if not isinstance(question, str) or question not in QUESTIONS:
        raise ValueError(f"question = {question!r}: one of {', '.join(QUESTIONS)} is needed")
    tol = real_number("tol", tol, above=0.0)
    form = NormalForm.of(params)
    params = without_extensions(form.params)
    alpha1, alpha2 = form.angles(real_array("alpha1", alpha1), real_array("alpha2", alpha2))
    motion = contact_motion(params, alpha1, alpha2)
    certificate = contact_certificate(params, alpha1, alpha2, t_end)
    shift = geometry_shift(motion, certificate, params)
    choices = Choices(
        level=np.full(alpha1.shape, Level.a1, dtype=int),
        value=np.full(alpha1.shape, np.nan),
        integrated=np.zeros(alpha1.shape),
        motion=motion,
        shift=shift,
        certificate=certificate,
        margin=np.full(alpha1.shape, np.nan),
        reach=first_integral_reach(params, alpha1, alpha2),
    )
    runs = _Runs(form.params, alpha1, alpha2, t_end, workers)
    if params is form.params:  # else no certificate holds: dashpots or another friction law
        _answer_below_a1(choices, question, tol, runs)
    _run_once(choices, np.ones(alpha1.shape, dtype=bool), question, 1.0, runs)
    return choices


def _answer_below_a1(choices: Choices, question: str, tol: float, runs: _Runs) -> None:
    """What the cheaper levels answer, where their certificates hold."""
    keeps, motion, shift = choices.certificate.keeps, choices.motion, choices.shift
    if question == "contact_lost":
        choices.level[keeps], choices.value[keeps] = Level.closed_form, 0.0
        return
    if question == "peak_contact_force":
        _answer_by_first_integral(choices, tol, runs)
    _answer_in_contact(choices, keeps & (shift <= GEOMETRY_SHARE * tol), question, runs)
    # what a mass does after it has lost contact, no part of the horizon tells
    stays = motion.oscillates & (motion.highest() / runs.params.preload - 1.0 <= shift)
    end = SHORT_RUN[question] * runs.t_end
    slower, faster = motion.omega.min(axis=-1), motion.omega.max(axis=-1)
    stays &= slower * end > 2.0 * math.pi * LEAST_PERIODS
    if question == "frequency":
        stays &= _dominant_mode(motion)[0] & ((faster - slower) * end > LINE_WIDTH)
    _run_once(choices, stays, question, SHORT_RUN[question], runs)


class _Runs(NamedTuple):
    """What all runs of a choice share."""

    params: Parameters
    alpha1: np.ndarray
    alpha2: np.ndarray
    t_end: float
    workers: int | None


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
        stop_at_first_separation=share < 1.0 or question == "contact_lost", workers=runs.workers,
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
    alpha1, alpha2 = np.asarray(alpha1, float), np.asarray(alpha2, float)
    stiffness, determinant, invariants = contact_system(params, alpha1, alpha2)
    x, y, _ = a3.static_state(
        stiffness, determinant, k3=params.k3, mu=params.drag, actuation=params.k3 * params.preload
    )
    a11, a12, a21, a22 = (
        value / params.mass for value in a4.contact_matrix(stiffness, params.k3, params.drag)
    )
    first, second = a4.natural_frequencies_squared(invariants)
    return modal_motion((a11, a12, a21, a22), (first, second), (x, y))


def geometry_shift(motion: ModalMotion, certificate: Certificate, params: Parameters) -> np.ndarray:
    """By how much the springs' geometry moves the linear motion, relative; ∞ where unknown.

    The largest of what it changes at the two frequencies, at the bounds on y and on the distance,
    by its linear part (the motion about A1's own equilibrium) and by its quadratic part.
    """
    own, moved = certificate.second
    distance = own.farthest()
    with np.errstate(invalid="ignore"):
        height = np.abs(motion.highest() - own.highest()) + moved[..., 1]
        reach = np.abs(motion.farthest() - distance) + np.hypot(moved[..., 0], moved[..., 1])
        slower = np.abs(motion.omega / own.omega - 1.0).max(axis=-1)
        found = np.maximum(np.maximum(height / params.preload, reach / distance), slower)
    return np.where(motion.oscillates & own.oscillates, found, np.inf)


def _answer_in_contact(choices: Choices, cells: np.ndarray, question: str, runs: _Runs) -> None:
    """Level and value of the cells where the linear motion itself answers."""
    if not cells.any():
        return
    motion = choices.motion
    if question == "frequency":
        dominates, omega = _dominant_mode(motion)
        clear = cells & dominates
        choices.value[clear], choices.level[clear] = omega[clear], Level.closed_form
        return
    times = sample_times(runs.params, runs.t_end)
    x, y = ModalMotion(*(field[cells] for field in motion)).positions(times)
    choices.value[cells] = answer_of_samples(x, y, question, runs.params, times)
    choices.level[cells] = Level.a3_in_contact


def _dominant_mode(motion: ModalMotion) -> tuple[np.ndarray, np.ndarray]:
    """Whether one mode clearly dominates y, and the frequency of the larger one, rad/s.

    Of modes of nearly equal size, which one dominates hangs on what the linear model drops.
    """
    size = np.abs(motion.y_mode)
    larger = size.argmax(axis=-1)[..., None]
    omega = np.take_along_axis(motion.omega, larger, axis=-1)[..., 0]
    return size.max(axis=-1) > UNEQUAL * size.min(axis=-1), omega


def _answer_by_first_integral(choices: Choices, tol: float, runs: _Runs) -> None:
    """The force of the start, where the first integral of A4 lets none be larger.

    The springs' geometry changes their force by the share r/L, which must be within the
    tolerance for the largest r, and must not make the sliding state unstable, for then small
    changes add up. That is no proof: in 90 of 137,000 random cells that pass, the force is
    larger than that of the start by more than r/L.
    """
    params = runs.params
    within = choices.reach.distance <= tol * min(params.length1, params.length2)
    within &= choices.certificate.second.motion.oscillates
    cells = within & slides(choices.reach.speed, params)
    choices.value[cells], choices.level[cells] = 1.0, Level.closed_form


def first_integral_reach(params: Parameters, alpha1: Any, alpha2: Any) -> a4.ReachFromRest:
    """Bounds of A4 from rest over arrays of angles."""
    stiffness = linear_stiffness(params, geometry(np.asarray(alpha1), np.asarray(alpha2)))
    return a4.reach_from_rest(stiffness, params.drag, params)


def _reason(level: Level, question: str) -> str:
    if level == Level.closed_form and question == "contact_lost":
        return "the bound on y keeps clear of l_pre by the measured margin"
    if level == Level.closed_form and question == "peak_contact_force":
        return "the first integral of A4 allows no larger force than that of the start"
    if level == Level.closed_form:
        return "contact is never lost and one linear mode dominates"
    if level == Level.a3_in_contact:
        return "contact is never lost and the geometry's share is within the tolerance"
    if level == Level.a1_short:
        return "contact is kept with a margin over a part of the horizon that shows both modes"
    return "no cheaper level keeps its own assumptions within the tolerance"


def _checks(found: Choices, params: Parameters, question: str, tol: float) -> tuple[Check, ...]:
    certificate, shift = found.certificate, float(found.shift[0])
    own, moved = certificate.second
    ratio = float(own.omega[0, 1] / own.omega[0, 0])
    coulomb = without_extensions(params) is params
    checks = [
        Check("no dashpots, Coulomb friction with one μ", coulomb, "what the certificates are of"),
        Check("motion in contact oscillates", bool(own.oscillates[0]), "both ω² real and positive"),
        Check(
            "slower than the belt",
            bool(certificate.slides[0]),
            f"|x'| ≤ {float(own.fastest()[0]):.3g}, |V| = {abs(params.belt_speed):.3g}",
        ),
        Check("margin measured here", bool(certificate.in_range[0]), "parameters and horizon"),
        Check("no resonance of low order", bool(certificate.detuned[0]), f"ω2/ω1 = {ratio:.3g}"),
        Check(
            "second order is small",
            bool(certificate.mild[0]),
            f"x ± {float(moved[0, 0]):.2g}, y ± {float(moved[0, 1]):.2g}",
        ),
        Check(
            "contact never lost",
            bool(certificate.keeps[0]),
            f"linear bound y ≤ {float(certificate.highest[0]):.3g}, l_pre = {params.preload:.3g}",
        ),
    ]
    if question != "contact_lost":
        allowed = GEOMETRY_SHARE * tol
        checks.append(
            Check("geometry within tolerance", shift <= allowed, f"{shift:.2g} ≤ {allowed:.2g}?")
        )
    if question == "peak_contact_force":
        distance = float(found.reach.distance[0])
        allowed = tol * min(params.length1, params.length2)
        checks.append(
            Check(
                "first integral bounds the motion",
                distance <= allowed,
                f"√(x² + y²) ≤ {distance:.3g}, {allowed:.3g} allowed",
            )
        )
    margin = float(found.margin[0])
    if math.isfinite(margin):
        checks.append(
            Check("contact force left in a short run", margin >= LEAST_FORCE, f"{margin:.2g}")
        )
    return tuple(checks)
