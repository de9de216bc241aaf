"""Ensembles of nonlinear runs: any number of lanes, each with its own parameters and angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.methods.lanes import LANES, Workspace, drive
from squealpipe.methods.processes import run_shared
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.tasks import lane_layout as layout
from squealpipe.tasks.a1_system import lane_integrator
from squealpipe.tasks.ensemble_jobs import Jobs
from squealpipe.tasks.lane_kernel import lane_kernel

BLOCK = 2**17
"""Runs of a map that are held in memory at once, about 1 kB each."""


@dataclass(frozen=True)
class Ensemble:
    """Results of an ensemble; arrays have the broadcast shape of its inputs, SI units.

    Attributes:
        outcome: ``schema.Outcome`` of each run.
        time: time reached, s.
        first_separation_time: s, NaN where contact was never lost.
        separated_time, stick_time: total time in those regimes, s.
        peak_contact_force, lowest_contact_force: extremes of N/(k3 l_pre) while in contact.
        max_displacement: largest √(x² + y²), m.
        early_max_x, late_max_x: largest |x| before and after ``t_late``, m.
        max_vx: largest ẋ at the ends of integration steps, m/s.
        nearest_pivot: smallest distance to a fixed end at step ends, in free lengths.
        turns: net turns around both fixed ends, counterclockwise positive.
        separations, contacts, sticks, slips, reversals: event counts.
        steps: integration steps.
        final_state: (…, 4) x, y, vx, vy at ``time``, m and m/s; final_regime its regime.
        log_growth: ln of the growth of a perturbation (0 without ``tangent``).
        predictability_horizon: time at which an error of ``tol`` has grown to l_pre/1000, s;
            NaN: not before the end.
        samples, sample_regimes: states (…, n, 4) at ``times``; NaN and −1 past ``time``.
        event_times, event_kinds, event_states: the first ``log_events`` events; NaN and −1 after
            the last one.
    """

    outcome: np.ndarray
    time: np.ndarray
    first_separation_time: np.ndarray
    separated_time: np.ndarray
    stick_time: np.ndarray
    peak_contact_force: np.ndarray
    lowest_contact_force: np.ndarray
    max_displacement: np.ndarray
    early_max_x: np.ndarray
    late_max_x: np.ndarray
    max_vx: np.ndarray
    nearest_pivot: np.ndarray
    turns: np.ndarray
    separations: np.ndarray
    contacts: np.ndarray
    sticks: np.ndarray
    slips: np.ndarray
    reversals: np.ndarray
    steps: np.ndarray
    final_state: np.ndarray
    final_regime: np.ndarray
    log_growth: np.ndarray
    predictability_horizon: np.ndarray
    samples: np.ndarray
    sample_regimes: np.ndarray
    event_times: np.ndarray
    event_kinds: np.ndarray
    event_states: np.ndarray


def run_ensemble(
    parameters: Parameters | Mapping[str, Any],
    alpha1: Any,
    alpha2: Any,
    *,
    t_end: Any,
    model: str = "A1",
    tol: float = 1e-12,
    initial_state: Any = (0.0, 0.0, 0.0, 0.0),
    times: Any = None,
    stop_at_first_separation: bool = False,
    stop_at_x: Any = math.inf,
    stop_at_turns: float = math.inf,
    t_late: Any = math.inf,
    tangent: bool = False,
    log_events: int = 0,
    workers: int | None = None,
) -> Ensemble:
    """Integrate many runs at once; every argument may differ from run to run.

    ``parameters`` (values of the mapping), ``alpha1``, ``alpha2``, ``t_end``, ``stop_at_x`` and
    ``t_late`` are broadcast against one another; the results have that shape. Units of mass,
    stiffness and length may differ between runs too: each is integrated in units of
    m = k1 = l_pre = 1.

    Args:
        parameters: ``Parameters``, or a mapping of its field names to arrays; fields left out
            take the baseline's value.
        alpha1, alpha2: spring angles, rad.
        t_end: end of each run, s.
        model: "A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs" or "A4".
        tol: tolerance of the Taylor integrator.
        initial_state: (x, y, vx, vy) in m and m/s, broadcast over the runs (last axis 4).
        times: instants (last axis), the same for all runs or one row a run, s, ascending.
        stop_at_first_separation: end a run there with outcome ``separated``.
        stop_at_x: end a run when |x| exceeds this, m, with outcome ``amplitude_reached``.
        stop_at_turns: end a run at this many net turns around both fixed ends, likewise.
        t_late: where ``early_max_x`` ends and ``late_max_x`` starts, s.
        tangent: carry one perturbation along (for the predictability horizon).
        log_events: number of events a run to keep.
        workers: processes; None takes all cores. The results are the same bit for bit.

    Raises:
        ValueError: an unknown model or parameter, a value that is not finite or not allowed, or
            shapes that do not broadcast.
    """
    jobs = Jobs.build(
        parameters,
        alpha1,
        alpha2,
        t_end=t_end,
        model=model,
        tol=tol,
        initial_state=initial_state,
        times=times,
        stop_at_first_separation=stop_at_first_separation,
        stop_at_x=stop_at_x,
        stop_at_turns=stop_at_turns,
        t_late=t_late,
    )
    size = len(jobs.orders)
    shapes = {
        "results": ((size, layout.N_RESULTS), np.float64),
        "counts": ((size, layout.N_COUNTS), np.int64),
        "samples": ((size, jobs.times.shape[1], 4), np.float64),
        "sample_regimes": ((size, jobs.times.shape[1]), np.int64),
        "event_times": ((size, log_events), np.float64),
        "event_kinds": ((size, log_events), np.int64),
        "event_states": ((size, log_events, 4), np.float64),
    }
    linear = VARIANT_RULES[model].linear_springs
    # Compiled before the processes fork, so that all share one copy.
    lane_integrator(linear_springs=linear, tangent=tangent, tol=tol)
    lane_kernel()

    def work(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        integrator = lane_integrator(linear_springs=linear, tangent=tangent, tol=tol)
        _run_lanes(integrator, jobs, arrays, first, stride)

    arrays = run_shared(work, shapes, jobs=size, workers=workers)
    return _results(jobs, arrays)


def run_map(
    parameters: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    wanted: Sequence[str],
    **options: Any,
) -> SimpleNamespace:
    """Some results of an ensemble over both angles, in blocks of rows, so that memory stays small.

    Args:
        parameters: physical parameters.
        alpha1, alpha2: 1-D arrays of angles, rad.
        wanted: attributes of :class:`Ensemble` to keep.
        options: further arguments of :func:`run_ensemble`.

    Returns:
        The wanted arrays, each (alpha1, alpha2).
    """
    rows = max(1, BLOCK // alpha2.size)
    parts: dict[str, list[np.ndarray]] = {name: [] for name in wanted}
    for first in range(0, alpha1.size, rows):
        run = run_ensemble(parameters, alpha1[first : first + rows, None], alpha2, **options)
        for name in wanted:
            parts[name].append(getattr(run, name))
    return SimpleNamespace(**{name: np.concatenate(arrays) for name, arrays in parts.items()})


def _run_lanes(
    integrator: Any, jobs: Jobs, arrays: dict[str, np.ndarray], first: int, stride: int
) -> None:
    """Run the jobs first, first + stride, … in one process."""
    for name, fill in (("samples", np.nan), ("event_times", np.nan), ("event_states", np.nan)):
        arrays[name][first::stride] = fill
    for name in ("sample_regimes", "event_kinds"):
        arrays[name][first::stride] = -1
    memory = np.zeros((LANES, layout.N_MEMORY))
    integers = np.full((LANES, layout.N_INTEGERS), layout.EMPTY, np.int64)
    queue = np.array([first, len(jobs.orders), stride], np.int64)
    workspace = Workspace(
        [
            integrator.state,
            integrator.pars,
            integrator.tc,
            integrator.last_h,
            memory,
            integers,
            jobs.orders,
            jobs.initial,
            arrays["results"],
            arrays["counts"],
            jobs.times,
            arrays["samples"],
            arrays["sample_regimes"],
            arrays["event_times"],
            arrays["event_kinds"],
            arrays["event_states"],
            queue,
        ],
        [
            integrator.state.shape[0],
            integrator.pars.shape[0],
            integrator.tc.shape[1],
            len(jobs.orders),
            jobs.times.shape[1],
            arrays["event_times"].shape[1],
        ],
    )
    integrator.set_time(0.0)
    drive(integrator, lane_kernel(), workspace)


def _results(jobs: Jobs, arrays: dict[str, np.ndarray]) -> Ensemble:
    """Results in the caller's units and shape."""
    result, count = arrays["results"].T, arrays["counts"].T
    t, length = jobs.time_unit, jobs.length
    speed = length / t
    scale = np.stack([length, length, speed, speed], axis=-1)[:, None, :]
    separated = result[layout.LOWEST_Y] == np.inf
    flat = {
        "outcome": count[layout.OUTCOME].astype(np.int8),
        "time": result[layout.TIME] * t,
        "first_separation_time": result[layout.FIRST_SEPARATION] * t,
        "separated_time": result[layout.SEPARATED_TIME] * t,
        "stick_time": result[layout.STICK_TIME] * t,
        "peak_contact_force": np.where(separated, 0.0, 1.0 - result[layout.LOWEST_Y]),
        "lowest_contact_force": np.where(separated, 0.0, 1.0 - result[layout.HIGHEST_Y]),
        "max_displacement": np.sqrt(result[layout.LARGEST_R2]) * length,
        "early_max_x": result[layout.EARLY_LARGEST_X] * length,
        "late_max_x": result[layout.LATE_LARGEST_X] * length,
        "max_vx": result[layout.LARGEST_SPEED] * speed,
        "nearest_pivot": np.sqrt(result[layout.NEAREST_PIVOT2]),
        "turns": _common_turns(result[layout.HALF_TURNS1], result[layout.HALF_TURNS2]),
        "separations": count[layout.FIRST_KIND],
        "contacts": count[layout.FIRST_KIND + 1],
        "sticks": count[layout.FIRST_KIND + 2],
        "slips": count[layout.FIRST_KIND + 3],
        "reversals": count[layout.FIRST_KIND + 4],
        "steps": count[layout.STEPS],
        "final_state": result[layout.FINAL_STATE :].T * scale[:, 0],
        "final_regime": count[layout.REGIME].astype(np.int8),
        "log_growth": result[layout.LOG_GROWTH],
        "predictability_horizon": result[layout.HORIZON] * t,
        "samples": arrays["samples"] * scale,
        "sample_regimes": arrays["sample_regimes"].astype(np.int8),
        "event_times": arrays["event_times"] * t[:, None],
        "event_kinds": arrays["event_kinds"].astype(np.int8),
        "event_states": arrays["event_states"] * scale,
    }
    return Ensemble(
        **{name: values.reshape(jobs.shape + values.shape[1:]) for name, values in flat.items()}
    )


def _common_turns(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Turns around both points from half turns around each; 0 where they turn against another."""
    least = np.minimum(np.abs(first), np.abs(second))
    return np.where(first * second > 0, 0.5 * np.sign(first) * least, 0.0)
