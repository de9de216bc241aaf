"""The kind of motion of model A1, judged from the second half of a run."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.brake.a1.ensemble import Ensemble, integrate
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.schema import Outcome
from squealpipe.systems.recurrence import Recurrence, in_blocks, repeats_after


@dataclass(frozen=True)
class MotionClassification:
    """Limits by which the motion of a run of A1 is classified."""

    marks: tuple[float, float] = (0.5, 0.75)
    """Shares of a run between which, and its end, its quarters are judged; where they differ, the
    motion has changed."""
    least_turns: int = 3
    """Net turns in a run from which a motion can be a whirl."""
    at_rest: float = 1e-3
    """A mass rests that stays this close to where it ends, over its largest displacement."""
    same_statistics: float = 0.1
    """Largest Kolmogorov–Smirnov distance of both halves' intervals on a torus, where it falls
    like 1/n; the limit of random samples, 2.3/√n, would let the slow drift of damped motion
    pass."""
    least_compared: int = 30
    """Intervals of each kind in each half from which a torus keeps to that distance."""
    turns_per_return: float = 0.5
    """Net turns for each return to the belt from which a motion is a whirl: a pendulum that goes
    over the top and back makes none, however long it lasts."""
    regular_growth_power: float = 2.0
    """A perturbation of a regular motion grows like this power of time at most; of a chaotic one,
    exponentially."""
    least_events: int = 4 * Recurrence.least_repeats
    """Events in the later half of a run from which a repetition is sought."""
    events_per_time: float = 0.5
    """Events in a :func:`linear_time` that a log has room for at first; the baseline has 0.35."""
    most_logged: int = 1024
    """Events of a run that are logged at first, at most."""


limits = MotionClassification()


def as_judged(t_end: Any) -> dict[str, Any]:
    """Arguments of ``run_ensemble`` for runs that :func:`classify_motion` is given."""
    times = np.multiply.outer(np.asarray(t_end, float), limits.marks)
    return {"t_end": t_end, "times": times, "sums": True, "tangent": True}


def with_log(t_end: float, params: Any) -> dict[str, Any]:
    """Arguments of ``run_ensemble`` for runs that :func:`judge` is given."""
    return {**as_judged(t_end), "log_events": room_for_events(t_end, params)}


def room_for_events(t_end: float, params: Any) -> int:
    """Events that the log of a run has room for, so that few are made again."""
    expected = limits.events_per_time * t_end / linear_time(params)
    return int(min(limits.least_events + expected, limits.most_logged))


def linear_time(params: Any) -> Any:
    """√(2m/(k1 + k2)), s: one over the root mean square of both separated natural frequencies.

    Their squares add up to (k1 + k2)/m at any angles, so mirror images have the same unit of
    time; for equal springs it is √(m/k1).
    """
    return np.sqrt(2.0 * params.mass / (params.k1 + params.k2))


def regular_growth(time: Any) -> Any:
    """Most that ln of a perturbation grows in a regular motion; time in :func:`linear_time`."""
    return limits.regular_growth_power * np.log1p(time)


def whirls(run: Ensemble) -> np.ndarray:
    """Return whether each run of an ensemble turns around both fixed ends, returns to the belt
    aside.
    """
    turns = np.abs(run.turns)
    return np.asarray(
        (turns >= limits.least_turns) & (turns > limits.turns_per_return * run.contacts)
    )


def predictability(run: Ensemble) -> dict[str, np.ndarray]:
    """Growth rate, horizon (the run's end where it lies beyond) and outcome, as datasets hold them.

    ``beyond_horizon`` is the outcome of a run whose state an error of ``tol`` decides before its
    end.
    """
    horizon = run.predictability_horizon
    chaotic = (run.outcome == Outcome.converged) & np.isfinite(horizon)
    return {
        # A run that ended early is averaged over the time that it lasted.
        "lyapunov_exponent": run.log_growth
        / np.maximum(run.time, np.finfo(float).tiny),
        "predictability_horizon": np.where(np.isnan(horizon), run.time, horizon),
        "outcome": np.where(chaotic, Outcome.beyond_horizon, run.outcome),
    }


def classify_motion(run: Ensemble, params: Any) -> tuple[Any, np.ndarray]:
    """(``MotionFlag`` of each run of an ensemble, whether it still changes).

    Judged from the second half of each run; a label still changes where the two quarters of that
    half have different ones (those in contact without stick are one). Hammering is *irregular*
    where a perturbation has grown by more than a share of the half (or quarter) of
    :func:`regular_growth`; of other hammering :func:`regular_kind` says more, and until then it is
    *undetermined*.

    Args:
        run: the runs, with ``max_displacement`` tracked and made :func:`as_judged`;
            ``final_state`` decides their shape.
        params: their parameters, numbers or arrays.
    """
    first, second, last = range(len(limits.marks) + 1)
    quarters = (_label(run, params, first, second), _label(run, params, second, last))
    # a motion that keeps contact may well come to rest
    # labels of motions that no longer lose contact count as one here
    calm = (
        MotionFlag.contact_kept,
        MotionFlag.hammered_then_contact,
        MotionFlag.at_rest,
    )
    changed = np.not_equal(*(np.where(np.isin(q, calm), calm[0], q) for q in quarters))
    return _label(run, params, first, last), changed


def _label(run: Any, params: Any, start: int, end: int) -> np.ndarray:
    """Labels by what happens between two marks; the last one is the end of the run."""

    def at(name: str, mark: int) -> np.ndarray:
        if mark == len(limits.marks):
            return np.asarray(getattr(run, "final_state" if name == "state" else name))
        if name == "state":
            return np.asarray(run.samples[..., mark, :])
        return np.asarray(getattr(run, f"sample_{name}")[..., mark])

    def during(name: str) -> np.ndarray:
        return np.asarray(at(name, end) - at(name, start))

    shares = (*limits.marks, 1.0)
    share = shares[end] - shares[start]
    unit = linear_time(params)
    scale = np.stack(np.broadcast_arrays(1.0, 1.0, unit, unit), axis=-1)
    length = np.asarray(run.max_displacement)[..., None]
    moved = np.abs(at("state", start) - run.final_state * [1.0, 1.0, 0.0, 0.0]) * scale
    speeds = np.abs(at("state", end) * [0.0, 0.0, 1.0, 1.0]) * scale
    rests = (np.maximum(moved, speeds) < limits.at_rest * length).all(axis=-1)
    kept = (during("separations") == 0) & (during("separated_time") == 0)
    turns = np.abs(during("turns"))
    whirling = (turns >= share * limits.least_turns) & (
        turns > limits.turns_per_return * during("contacts")
    )
    return np.select(
        [
            run.outcome != Outcome.converged,
            kept & rests,
            kept & (at("separated_time", end) > 0),
            kept & (during("stick_time") > 0),
            kept,
            whirling,
            during("log_growth") > share * regular_growth(run.time / unit),
        ],
        [
            MotionFlag.undetermined,
            MotionFlag.at_rest,
            MotionFlag.hammered_then_contact,
            MotionFlag.stick_slip,
            MotionFlag.contact_kept,
            MotionFlag.whirl,
            MotionFlag.irregular_hammering,
        ],
        MotionFlag.undetermined,
    )


def regular_kind(times: np.ndarray, kinds: np.ndarray, t_end: float) -> MotionFlag:
    """The kind of a regular hammering by the events of a run to ``t_end``.

    *Periodic*: kinds and intervals repeat in the later half within 1e-6 of their mean, three times
    at least. *Quasi-periodic*: they do not, and the intervals after each kind of event are
    distributed alike in both halves, at least 30 in each. *Undetermined*: neither, or too few
    events.
    """
    ran = times <= t_end
    times, kinds = times[ran], kinds[ran]
    late = times > 0.5 * t_end
    if np.count_nonzero(late) < limits.least_events:
        return MotionFlag.undetermined
    if repeats_after(times[late], kinds[late], Recurrence.repeated):
        return MotionFlag.periodic_hammering
    after, kinds, late = np.diff(times), kinds[:-1], late[:-1]
    for kind in np.unique(kinds):
        halves = after[(kinds == kind) & ~late], after[(kinds == kind) & late]
        if (
            min(map(len, halves)) < limits.least_compared
            or _distance(*halves) > limits.same_statistics
        ):
            return MotionFlag.undetermined
    return MotionFlag.quasi_periodic_hammering


def _distance(first: np.ndarray, second: np.ndarray) -> float:
    """Largest difference of two samples' distributions (``ks_2samp`` takes 50 times as long)."""
    values = np.concatenate([first, second])
    shares = [
        np.searchsorted(np.sort(each), values, side="right") / each.size
        for each in (first, second)
    ]
    return float(np.abs(shares[0] - shares[1]).max())


def judge(
    run: Ensemble, params: Any, t_end: float, *, workers: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """(``MotionFlag`` of each run, whether it still changes), hammering judged by its events.

    Runs that had more events than their log has room for are made again, with room for all.

    Args:
        run: made :func:`with_log`; as :func:`classify_motion` needs them.
        t_end: end of every run, s.
    """
    motion, changed = classify_motion(run, params)
    flat = motion.reshape(-1)
    undetermined = (flat == MotionFlag.undetermined) & (
        run.outcome.reshape(-1) == Outcome.converged
    )
    logged, events = run.logged.reshape(-1), run.events.reshape(-1)
    _judge_by_events(flat, np.flatnonzero(undetermined & logged), run, t_end)
    for rows in in_blocks(np.flatnonzero(undetermined & ~logged), events):
        again = integrate(
            run.jobs.some(rows),
            (),
            log_events=int(events[rows].max()),
            tangent=True,
            workers=workers,
        )
        labels = flat[rows]
        _judge_by_events(labels, np.arange(rows.size), again, t_end)
        flat[rows] = labels
    return flat.reshape(motion.shape), changed


def _judge_by_events(
    motion: np.ndarray, rows: np.ndarray, run: Ensemble, t_end: float
) -> None:
    """Label some of the runs by their logs."""
    times, kinds = (
        log.reshape(-1, log.shape[-1]) for log in (run.event_times, run.event_kinds)
    )
    for row in rows:
        motion[row] = regular_kind(times[row], kinds[row], t_end)
