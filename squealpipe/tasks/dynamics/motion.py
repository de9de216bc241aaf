"""Kinds of motion of model A1: what is tested for each label, and whether the label lasts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.methods.recurrence import LEAST_REPEATS, repeats_after
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.dynamics.runs import MotionFlag
from squealpipe.solvers.a1.ensemble import Ensemble, run_ensemble

LEAST_TURNS = 3
"""Net turns from which a motion can be a whirl."""
TURNS_PER_RETURN = 0.5
"""Net turns for each return to the belt from which it is one: a pendulum that goes over the top
and back makes none, however long it lasts."""
REGULAR_GROWTH_POWER = 2.0
"""A perturbation of a regular motion grows like a power of time, of a chaotic one exponentially."""
INTERVAL_TOLERANCE = 1e-6
"""Largest difference of event intervals that counts as a repetition, over the period."""
LEAST_EVENTS = 4 * LEAST_REPEATS
"""Events in the later half of a run from which a repetition can be told from none."""
EVENTS_AT_ONCE = 2**20
"""Logged events that are held in memory at once, 48 bytes each."""
CONTACT = (MotionFlag.perpetual_contact, MotionFlag.stick_slip)


def linear_time(params: Parameters) -> float:
    """√(2m/(k1 + k2)), s: one over the root mean square of both separated natural frequencies.

    Their squares add up to (k1 + k2)/m at any angles, so mirror images have the same unit of
    time; for equal springs it is √(m/k1).
    """
    return math.sqrt(2.0 * params.mass / (params.k1 + params.k2))


def regular_growth(time: Any) -> Any:
    """Most that ln of a perturbation grows in a regular motion; time in :func:`linear_time`."""
    return REGULAR_GROWTH_POWER * np.log1p(time)


def whirls(run: Ensemble | SimpleNamespace) -> np.ndarray:
    """Whether each run of an ensemble turns around both fixed ends, returns to the belt aside."""
    turns = np.abs(run.turns)
    return np.asarray((turns >= LEAST_TURNS) & (turns > TURNS_PER_RETURN * run.contacts))


def predictability(run: Ensemble | SimpleNamespace) -> dict[str, np.ndarray]:
    """Growth rate, horizon (the run's end where it lies beyond) and outcome, as datasets hold them.

    ``beyond_horizon`` is the outcome of a run whose state an error of ``tol`` decides before its
    end.
    """
    horizon = run.predictability_horizon
    chaotic = (run.outcome == Outcome.converged) & np.isfinite(horizon)
    return {
        # A run that ended early is averaged over the time that it lasted.
        "lyapunov_exponent": run.log_growth / np.maximum(run.time, np.finfo(float).tiny),
        "predictability_horizon": np.where(np.isnan(horizon), run.time, horizon),
        "outcome": np.where(chaotic, Outcome.beyond_horizon, run.outcome),
    }


def classify_motion(run: Ensemble | SimpleNamespace, time_unit: float) -> np.ndarray:
    """``MotionFlag`` of each run of an ensemble with ``tangent=True``.

    Hammering is *irregular* where a perturbation has grown faster than (1 + t)², t in
    ``time_unit``, and else *regular* to the end of the run; :func:`tell_periodic` says more.
    """
    return np.select(
        [
            (run.separations == 0) & (run.separated_time == 0) & (run.stick_time == 0),
            (run.separations == 0) & (run.separated_time == 0),
            whirls(run),
            run.log_growth > regular_growth(run.time / time_unit),
        ],
        [
            MotionFlag.perpetual_contact,
            MotionFlag.stick_slip,
            MotionFlag.whirl,
            MotionFlag.irregular_hammering,
        ],
        MotionFlag.regular_hammering,
    )


def tell_periodic(times: np.ndarray, kinds: np.ndarray, t_end: float) -> MotionFlag:
    """The kind of a regular hammering by the events of the later half of a run to ``t_end``.

    *Periodic*: kinds and intervals repeat within 1e-6 of the period, three times at least.
    *Quasi-periodic*: they do not. *Regular*: there are too few events to tell.
    """
    late = (times > 0.5 * t_end) & (times <= t_end)
    if np.count_nonzero(late) < LEAST_EVENTS:
        return MotionFlag.regular_hammering
    if repeats_after(times[late], kinds[late], INTERVAL_TOLERANCE):
        return MotionFlag.periodic_hammering
    return MotionFlag.quasi_periodic_hammering


def refine_labels(
    params: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    run: Ensemble | SimpleNamespace,
    motion: np.ndarray,
    *,
    t_end: float,
    tol: float,
    workers: int | None,
) -> tuple[np.ndarray, np.ndarray]:
    """(labels of the runs, labels of the same runs at 2 ``t_end``), regular hammering told apart.

    Runs in contact are carried on from their last state; the others start again, from rest, for
    twice as long, with their events logged.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles of the runs, 1-D, rad.
        run: their results to ``t_end``, 1-D: events, stick time, state and regime at the end.
        motion: their labels by :func:`classify_motion`.
        t_end: end of the runs, s.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.
    """
    motion, later = motion.copy(), motion.copy()
    unit = linear_time(params)
    kept = np.flatnonzero(np.isin(motion, CONTACT) & np.isfinite(run.final_state).all(axis=-1))
    again = ~np.isin(motion, CONTACT)
    if kept.size:
        on = run_ensemble(
            params, alpha1[kept], alpha2[kept], t_end=t_end, tol=tol,
            initial_state=run.final_state[kept], stop_at_first_separation=True, workers=workers,
        )  # fmt: skip
        again[kept] = on.separations > 0
        later[kept[on.stick_time > 0]] = MotionFlag.stick_slip
    for cells in _blocks(np.flatnonzero(again), run.events):
        # twice the time holds about twice the events; a steadier first half holds fewer
        on = run_ensemble(
            params, alpha1[cells], alpha2[cells], t_end=2.0 * t_end, tol=tol, tangent=True,
            log_events=int(3 * run.events[cells].max() + 4 * LEAST_EVENTS), workers=workers,
        )  # fmt: skip
        later[cells] = classify_motion(on, unit)
        for label, end in ((motion, t_end), (later, 2.0 * t_end)):
            for row in np.flatnonzero(label[cells] == MotionFlag.regular_hammering):
                label[cells[row]] = tell_periodic(on.event_times[row], on.event_kinds[row], end)
    return motion, later


def _blocks(cells: np.ndarray, events: np.ndarray) -> Iterator[np.ndarray]:
    """The cells by number of events, in blocks that hold about EVENTS_AT_ONCE of them."""
    cells = cells[np.argsort(events[cells], kind="stable")]
    while cells.size:
        # as many of the busiest as fit, so that no block is wider than it needs to be
        size = max(1, EVENTS_AT_ONCE // int(3 * events[cells[-1]] + 4 * LEAST_EVENTS))
        yield cells[-size:]
        cells = cells[:-size]
