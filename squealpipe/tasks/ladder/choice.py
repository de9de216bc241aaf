"""No more model than a scene needs: which level answers a question within a tolerance, and why.

Three ways to an answer, cheapest first. Closed form: the motion about A1's own equilibrium, with
what geometry adds to it to second order, tells whether contact is kept, the frequency, and an upper
bound on force and distance (:mod:`squealpipe.tasks.ladder.certificate`); where the first integral
of A4 is definite, it bounds the contact force, contact lost or not. Short run: what A1 has reached
after a part of the horizon it has reached at its end too, so that the largest force and distance
lie between those of the part and the upper bound; how long the part must be, follows for each cell
from its linear motion. Else A1. What no bound holds, no part of the horizon tells.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from squealpipe.methods.modal_bounds import ModalMotion
from squealpipe.models import a4
from squealpipe.models.refusals import without_extensions
from squealpipe.parameters import HORIZON, Parameters
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.ladder.certificate import (
    BOUND_SAMPLE,
    CONTACT_SAMPLE,
    FIRST_INTEGRAL_SAMPLE,
    FREQUENCY_SAMPLE,
    Certificate,
    contact_certificate,
    dominance,
    first_integral_error,
    first_integral_reach,
)
from squealpipe.tasks.ladder.questions import (
    answer_of,
    dominant_frequency,
)
from squealpipe.tasks.normal_form import NormalForm
from squealpipe.tasks.sampling import sample_times
from squealpipe.validation import Angle, Positive, checked, one_of

"""Horizon unless told otherwise, √(m/k1)."""
LONGEST_PART = 0.5
"""Share of the horizon beyond which a part of it is not tried: failing would cost more than A1."""
ROUND_OFF = 1e-9
"""Of a bound on force or distance, relative."""


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
        value: the answer: truth value, rad/s, N_max/(k3 l_pre), or m. Of a force or distance that
            is known to lie between two bounds, the one that is as far from both, relative.
        reason: why this level; where that is measured and not proved, in how many random cells.
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
        certificate: what is known of contact without a run.
        reach: how far and fast the first integral of A4 lets the mass go; ∞ where it does not say.
        lower, upper: what the answer lies between, in its unit; NaN where no bound was asked for.
    """

    level: np.ndarray
    value: np.ndarray
    integrated: np.ndarray
    certificate: Certificate
    reach: a4.ReachFromRest
    lower: np.ndarray
    upper: np.ndarray


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

    That a cheaper level than A1 keeps to the tolerance is measured at random parameters, not
    proved; ``reason`` names the sample. Outside of the range of the sample
    (:class:`squealpipe.tasks.ladder.certificate.Measured`) A1 answers. A1 is run on the mirror
    image with V ≥ 0 and the stiffer spring first: in a chaotic motion, whose numbers round-off
    decides beyond its predictability horizon, that is another sample than a run as given.

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
        checks=_checks(found, params, question, tol, horizon),
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
    form = NormalForm.of(params)
    params = without_extensions(form.params)
    alpha1, alpha2 = form.angles(alpha1, alpha2)
    choices = Choices(
        level=np.full(alpha1.shape, Level.a1, dtype=int),
        value=np.full(alpha1.shape, np.nan),
        integrated=np.zeros(alpha1.shape),
        certificate=contact_certificate(params, alpha1, alpha2, t_end),
        reach=first_integral_reach(params, alpha1, alpha2),
        lower=np.full(alpha1.shape, np.nan),
        upper=np.full(alpha1.shape, np.nan),
    )
    runs = _Runs(form.params, alpha1, alpha2, t_end, workers)
    if params is form.params:  # else no certificate holds: dashpots or another friction law
        _answer_below_a1(choices, question, tol, runs)
    _run_to_the_end(choices, question, runs)
    return choices


class _Runs(NamedTuple):
    """What all runs of a choice share."""

    params: Parameters
    alpha1: np.ndarray
    alpha2: np.ndarray
    t_end: float
    workers: int | None


def _run_to_the_end(choices: Choices, question: str, runs: _Runs) -> None:
    """A1 over the whole horizon where nothing cheaper has answered."""
    open_ = np.isnan(choices.value)
    if not open_.any():
        return
    times = sample_times(runs.params, runs.t_end)
    run = run_ensemble(
        runs.params, runs.alpha1[open_], runs.alpha2[open_], t_end=runs.t_end,
        times=times if question == "frequency" else None,
        stop_at_first_separation=question == "contact_lost", workers=runs.workers,
    )  # fmt: skip
    choices.integrated[open_] += run.time
    choices.value[open_] = answer_of(run, question, times)


def _answer_below_a1(choices: Choices, question: str, tol: float, runs: _Runs) -> None:
    """What the cheaper levels answer, where their certificates hold."""
    keeps = choices.certificate.keeps
    if question == "contact_lost":
        choices.level[keeps], choices.value[keeps] = Level.closed_form, 0.0
        return
    if question == "frequency":
        _answer_by_both_modes(choices, tol, runs)
        return
    _bound(choices, question, runs)
    if question == "peak_contact_force":  # at least that of the start
        _settle(choices, np.flatnonzero(keeps), Level.closed_form, tol)
        _answer_by_first_integral(choices, tol, runs)
    _answer_by_short_run(choices, question, tol, runs)


def _answer_by_both_modes(choices: Choices, tol: float, runs: _Runs) -> None:
    """The dominant frequency of the linear motion, seen through the same window as A1's.

    Through a window that shows few periods even a pure oscillation has another frequency.
    """
    found = dominance(choices.certificate, runs.t_end)
    cells = np.flatnonzero(choices.certificate.keeps & found.dominates & (found.error <= tol))
    if not cells.size:
        return
    times = sample_times(runs.params, runs.t_end)
    _, y = _of_cells(choices.certificate.second.motion, cells).positions(times)
    choices.value.flat[cells] = dominant_frequency(y, times)
    choices.level.flat[cells] = Level.closed_form


def _bound(choices: Choices, question: str, runs: _Runs) -> None:
    """What force or distance lies between where contact is certified."""
    certificate, keeps = choices.certificate, choices.certificate.keeps
    if question == "peak_contact_force":
        choices.upper[keeps] = certificate.largest_force(runs.params.preload)[keeps]
        choices.lower[keeps] = 1.0
    else:
        choices.upper[keeps] = certificate.largest_distance()[keeps]
        choices.lower[keeps] = 0.0


def _answer_by_short_run(choices: Choices, question: str, tol: float, runs: _Runs) -> None:
    """What A1 has reached after a part of the horizon, and the bound that it never exceeds."""
    left = np.flatnonzero(choices.certificate.keeps & np.isnan(choices.value))
    ends = _first_reached(choices, left, question, tol, runs)
    cells, ends = left[np.isfinite(ends)], ends[np.isfinite(ends)]
    if not cells.size:
        return
    run = run_ensemble(
        runs.params, runs.alpha1.flat[cells], runs.alpha2.flat[cells], t_end=ends,
        stop_at_first_separation=True, workers=runs.workers,
    )  # fmt: skip
    choices.integrated.flat[cells] += run.time
    reached = answer_of(run, question, ends)
    choices.lower.flat[cells] = reached
    as_certified = (run.events == 0) & (reached <= choices.upper.flat[cells] * (1.0 + ROUND_OFF))
    _settle(choices, cells[as_certified], Level.a1_short, tol)


def _settle(choices: Choices, cells: np.ndarray, level: Level, tol: float) -> None:
    """Answer those cells whose bounds are close enough to one another.

    Of lower L and upper U the answer is 2 L U/(L + U), which is as far from both: within
    (U − L)/(U + L) of whatever lies between them.
    """
    lower, upper = choices.lower.flat[cells], choices.upper.flat[cells]
    close = upper - lower <= tol * (upper + lower)
    lower, upper, cells = lower[close], upper[close], cells[close]
    choices.value.flat[cells] = 2.0 * lower * upper / (lower + upper)
    choices.level.flat[cells] = level


def _first_reached(
    choices: Choices, cells: np.ndarray, question: str, tol: float, runs: _Runs
) -> np.ndarray:
    """When the linear motion has reached enough for an answer, s; NaN for not in time.

    A guess that decides what a run costs, not whether its answer is trusted.
    """
    certificate = choices.certificate
    motion = _of_cells(certificate.second.motion, cells)
    upper = choices.upper.flat[cells]
    needed = upper * (1.0 - tol) / (1.0 + tol)
    times = sample_times(runs.params, runs.t_end)
    times = times[1:][times[1:] <= LONGEST_PART * runs.t_end]
    x, y = motion.positions(times)
    reached = 1.0 - y / runs.params.preload if question == "peak_contact_force" else np.hypot(x, y)
    # half-way to the most that the linear motion ever reaches, so that A1 need not follow closely
    aim = needed + 0.5 * np.maximum(reached.max(axis=-1) - needed, 0.0)
    there = reached >= aim[:, None]
    return np.where(there.any(axis=-1), times[there.argmax(axis=-1)], np.nan)


def _of_cells(motion: ModalMotion, cells: np.ndarray) -> ModalMotion:
    """A motion at some cells, counted flat; one row each."""
    oscillates, *rest = motion
    return ModalMotion(oscillates.flat[cells], *(field.reshape(-1, 2)[cells] for field in rest))


def _answer_by_first_integral(choices: Choices, tol: float, runs: _Runs) -> None:
    """The force of the start, where the first integral of A4 lets none be larger."""
    error = first_integral_error(choices.certificate, choices.reach, runs.params)
    cells = (error <= tol) & np.isnan(choices.value)
    choices.value[cells], choices.level[cells] = 1.0, Level.closed_form
    choices.lower[cells] = choices.upper[cells] = np.nan


def _reason(found: Choices, level: Level, question: str) -> str:
    """Why this level; of what is measured, not proved, the sample."""
    if level == Level.a1:
        return "no cheaper level keeps its own assumptions within the tolerance"
    if question == "contact_lost":
        return f"the bound on y keeps clear of l_pre by a margin ({CONTACT_SAMPLE})"
    if question == "frequency":
        return f"contact is never lost and one linear mode dominates ({FREQUENCY_SAMPLE})"
    if math.isnan(found.upper[0]):
        return (
            "the first integral of A4 allows no larger force than that of the start, and geometry "
            f"changes it little ({FIRST_INTEGRAL_SAMPLE})"
        )
    least = "the start" if level == Level.closed_form else "a part of the horizon"
    return f"between what {least} reaches and a bound that is not exceeded ({BOUND_SAMPLE})"


def _checks(
    found: Choices, params: Parameters, question: str, tol: float, t_end: float
) -> tuple[Check, ...]:
    certificate = found.certificate
    own, moved, exchange = certificate.second
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
        Check(
            "no resonance of low order",
            bool(certificate.detuned[0]),
            f"ω2/ω1 = {ratio:.3g}, ω2 − ω1 adds {float(exchange[0]):.2g} of the slower mode",
        ),
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
    if question == "frequency":
        dominates, error = (field[0] for field in dominance(certificate, t_end))
        size = np.abs(own.y_mode[0])
        checks += [
            Check(
                "one mode dominates y",
                bool(dominates),
                f"amplitudes {size[0]:.3g} and {size[1]:.3g}, lines apart, periods enough",
            ),
            Check("second order within tolerance", bool(error <= tol), f"{error:.2g} ≤ {tol:.2g}?"),
        ]
    if question == "peak_contact_force":
        error = first_integral_error(certificate, found.reach, params)[0]
        checks.append(
            Check(
                "first integral bounds the force", bool(error <= tol), f"{error:.2g} ≤ {tol:.2g}?"
            )
        )
    lower, upper = float(found.lower[0]), float(found.upper[0])
    if math.isfinite(upper):
        close = upper - lower <= tol * (upper + lower)
        checks.append(Check("bounds within tolerance", close, f"{lower:.4g} to {upper:.4g}"))
    return tuple(checks)
