"""Ensembles of nonlinear runs: any number of lanes, each with its own parameters and angles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import BeforeValidator

from squealpipe.codes import Event
from squealpipe.methods.processes import run_shared
from squealpipe.methods.taylor.lanes import (
    INVERSES,
    ROUNDS,
    CompiledSystem,
    Workspace,
    aligned,
    drive,
    share_of,
    taylor_terms,
)
from squealpipe.methods.taylor.simd import FEW, LANES
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.solvers.a1.jobs import Jobs, Model
from squealpipe.solvers.a1.kernel import lane_kernel
from squealpipe.solvers.a1.own_laws import run_system
from squealpipe.solvers.a1.records import ARRAYS, IDLE, LANE, MARKS, QUEUE, RESULT, TABLE
from squealpipe.solvers.a1.system import Dissipation, compiled_system
from squealpipe.validation import Seed, Tolerance, Workers, checked

__all__ = ["MARKS", "Ensemble", "integrate", "run_ensemble", "run_map"]
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
        return_peak_contact_force: the largest from the first return to the belt on; NaN: none.
        impact_speed: largest |ẏ| at a return to the belt, m/s; NaN: none.
        max_displacement: largest √(x² + y²), m.
        early_max_x, late_max_x: largest |x| in integration steps that begin before ``t_late``, and
            from there on, m.
        early_max_vx, late_max_vx: largest |ẋ|, likewise, m/s.
        max_vx: largest ẋ at the ends of integration steps, m/s.
        nearest_pivot: smallest distance to a fixed end at step ends, in free lengths.
        turns: net turns around both fixed ends, counterclockwise positive; counted by half turns,
            so that the angle is known to half a turn.
        separations, contacts, sticks, slips, reversals: event counts; ``events`` their sum.
        steps: integration steps.
        final_state: (…, 4) x, y, vx, vy at ``time``, m and m/s; final_regime its regime.
        log_growth: ln of the growth of a perturbation (0 without ``tangent``).
        predictability_horizon: time at which an error of ``tol`` has grown to l_pre/1000, s;
            NaN: not before the end.
        mark_separated_time, mark_stick_time, mark_turns, mark_log_growth, mark_separations,
            mark_contacts, mark_state: what held at the ends of the steps that reached the shares
            :data:`MARKS` of the run, in a last axis (of the state, the last but one).
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
    return_peak_contact_force: np.ndarray
    impact_speed: np.ndarray
    max_displacement: np.ndarray
    early_max_x: np.ndarray
    late_max_x: np.ndarray
    early_max_vx: np.ndarray
    late_max_vx: np.ndarray
    max_vx: np.ndarray
    nearest_pivot: np.ndarray
    turns: np.ndarray
    separations: np.ndarray
    contacts: np.ndarray
    sticks: np.ndarray
    slips: np.ndarray
    reversals: np.ndarray
    events: np.ndarray
    steps: np.ndarray
    final_state: np.ndarray
    final_regime: np.ndarray
    log_growth: np.ndarray
    predictability_horizon: np.ndarray
    mark_separated_time: np.ndarray
    mark_stick_time: np.ndarray
    mark_turns: np.ndarray
    mark_log_growth: np.ndarray
    mark_separations: np.ndarray
    mark_contacts: np.ndarray
    mark_state: np.ndarray
    samples: np.ndarray
    sample_regimes: np.ndarray
    event_times: np.ndarray
    event_kinds: np.ndarray
    event_states: np.ndarray


def _fields(value: Any) -> Any:
    if not isinstance(value, Parameters | Mapping):
        raise ValueError(  # noqa: TRY004 (pydantic lets other errors through)
            "Parameters(...) or a mapping of their names to arrays is needed"
        )
    return value


Fields = Annotated[Any, BeforeValidator(_fields)]


@checked
def run_ensemble(
    parameters: Fields,
    alpha1: Any,
    alpha2: Any,
    *,
    t_end: Any,
    model: Model = "A1",
    tol: Tolerance = 1e-12,
    initial_state: Any = (0.0, 0.0, 0.0, 0.0),
    times: Any = None,
    stop_at_first_separation: bool = False,
    stop_at_x: Any = math.inf,
    stop_at_turns: float = math.inf,
    t_late: Any = math.inf,
    tangent: bool = False,
    log_events: Seed = 0,
    workers: Workers = None,
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
        model: "A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs", "A1-as-printed" or
            "A4".
        tol: tolerance of the Taylor integrator.
        initial_state: (x, y, vx, vy) in m and m/s, broadcast over the runs (last axis 4).
        times: instants (last axis), the same for all runs or one row per run, s, ascending.
        stop_at_first_separation: end a run there with outcome ``separated``.
        stop_at_x: end a run when |x| exceeds this, m, with outcome ``amplitude_reached``.
        stop_at_turns: end a run at this many net turns around both fixed ends, likewise.
        t_late: where ``early_max_x`` ends and ``late_max_x`` starts, at the end of a step, s.
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
    found = integrate(jobs, RESULTS, tangent=tangent, log_events=log_events, workers=workers)
    return Ensemble(**found)


def integrate(
    jobs: Jobs,
    wanted: Iterable[str],
    *,
    tangent: bool = False,
    log_events: int = 0,
    few: bool = False,
    workers: int | None = None,
) -> dict[str, np.ndarray]:
    """The results of some runs that are asked for, by their names in :class:`Ensemble`.

    Args:
        jobs: the runs.
        wanted: attributes of :class:`Ensemble`.
        tangent, log_events, workers: as in :func:`run_ensemble`.
        few: compute few lanes only, for at most ``simd.FEW`` runs: the same bits in half of the
            time, after another second of compilation.
    """
    groups = jobs.groups()
    if jobs.own is not None:
        found = run_system(jobs, jobs.own, set(wanted), tangent, log_events, workers)
    elif len(groups) == 1:
        (dissipation,) = groups
        found = _run(jobs, dissipation, wanted, tangent, log_events, few, workers)
    else:
        parts = [
            (rows, _run(jobs.subset(rows), dissipation, wanted, tangent, log_events, few, workers))
            for dissipation, rows in groups.items()
        ]
        found = {name: _joined([(rows, part[name]) for rows, part in parts]) for name in wanted}
    return {name: values.reshape(jobs.shape + values.shape[1:]) for name, values in found.items()}


def _run(
    jobs: Jobs,
    dissipation: Dissipation,
    wanted: Iterable[str],
    tangent: bool,
    log_events: int,
    few: bool,
    workers: int | None,
) -> dict[str, np.ndarray]:
    """Runs that share one compiled system; results in the caller's units, one row per run."""
    size = len(jobs.orders)
    shapes = {
        "results": ((size,), RESULT),
        "samples": ((size, jobs.times.shape[1], 4), np.float64),
        "sample_regimes": ((size, jobs.times.shape[1]), np.int64),
        "event_times": ((size, log_events), np.float64),
        "event_kinds": ((size, log_events), np.int64),
        "event_states": ((size, log_events, 4), np.float64),
    }
    # Compiled before the processes fork, so that all share one copy.
    system = compiled_system(
        linear_springs=VARIANT_RULES[jobs.model].linear_springs,
        dissipation=dissipation,
        tangent=tangent,
        few=few and size <= FEW,
    )
    lane_kernel()

    def work(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        _run_lanes(system, jobs, arrays, (first, stride), tangent=tangent)

    arrays = run_shared(work, shapes, jobs=size, workers=workers)
    raw, units = SimpleNamespace(**arrays), _Units.of(jobs)
    return {name: RESULTS[name](raw, units) for name in wanted}


def _joined(parts: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """An array over all runs from those over parts of the rows."""
    _, first = parts[0]
    whole = np.empty((sum(rows.size for rows, _ in parts), *first.shape[1:]), first.dtype)
    for rows, array in parts:
        whole[rows] = array
    return whole


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
    system: CompiledSystem,
    jobs: Jobs,
    arrays: dict[str, np.ndarray],
    share: tuple[int, int],
    *,
    tangent: bool,
) -> None:
    """Run the jobs first, first + stride, … in one process."""
    first, stride = share
    for name, fill in (("samples", np.nan), ("event_times", np.nan), ("event_states", np.nan)):
        arrays[name][first::stride] = fill
    for name in ("sample_regimes", "event_kinds"):
        arrays[name][first::stride] = -1
    # A run that never ends has failed.
    arrays["results"]["outcome"][first::stride] = Outcome.not_finite
    terms = taylor_terms(jobs.tol)
    # An idle lane keeps its last job's numbers, or these: no distance is zero.
    numbers = aligned(LANE.itemsize // 8)
    numbers[:] = 1.0
    lanes = np.ndarray(1, LANE, numbers)
    lanes["job"], lanes["longest_step"] = IDLE, np.inf
    arrays = arrays | {
        "lanes": lanes,
        "series": aligned(system.n_series, terms, LANES),
        "inverses": INVERSES,
        "orders": jobs.orders,
        "initial": jobs.initial,
        "sample_times": jobs.times,
        "queue": np.array([(first, len(jobs.orders), stride)], QUEUE),
    }
    sizes = {
        "n_terms": terms,
        "n_jobs": len(jobs.orders),
        "n_samples": jobs.times.shape[1],
        "n_logged": arrays["event_times"].shape[1],
        "n_rounds": ROUNDS,
        "tangent": tangent,
        "take_step": system.series,
        "perturb": system.perturb,
        "longest": system.longest,
    }
    table = Workspace(TABLE, {name: arrays[name] for name in ARRAYS}, sizes)
    queue, row = arrays["queue"].view("i8"), lanes[0]
    drive(lane_kernel(), table, lambda: share_of(row["job"], row["clock"], row["t_end"], queue))
    if lanes["job"].max() != IDLE or arrays["queue"][0]["next"] < len(jobs.orders):
        raise RuntimeError(
            "an exception in compiled code, reported above, ended the integration before its runs "
            "were finished; please report the parameters"
        )


class _Units(NamedTuple):
    """The caller's units, one row per run."""

    t: np.ndarray
    length: np.ndarray
    speed: np.ndarray
    state: np.ndarray

    @classmethod
    def of(cls, jobs: Jobs) -> _Units:
        length, speed = jobs.length, jobs.length / jobs.time_unit
        state = np.array([length, length, speed, speed]).T
        return cls(jobs.time_unit, length, speed, state)


def _force(raw: Any, row: str) -> Any:
    """N/(k3 l_pre) at an extreme of y; 0 where a run was never in contact."""
    separated = raw.results["lowest_y"] == np.inf
    return np.where(separated, 0.0, 1.0 - raw.results[row])


def _common_turns(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Turns around both points from half turns around each; 0 where they turn against another."""
    least = np.minimum(np.abs(first), np.abs(second))
    return np.where(first * second > 0, 0.5 * np.sign(first) * least, 0.0)


def _count(kind: int) -> Callable[[Any, _Units], Any]:
    return lambda raw, _: raw.results["kinds"][:, kind]


RESULTS: dict[str, Callable[[Any, _Units], Any]] = {
    "outcome": lambda raw, _: raw.results["outcome"].astype(np.int8),
    "time": lambda raw, u: raw.results["time"] * u.t,
    "first_separation_time": lambda raw, u: raw.results["first_separation"] * u.t,
    "separated_time": lambda raw, u: raw.results["separated_time"] * u.t,
    "stick_time": lambda raw, u: raw.results["stick_time"] * u.t,
    "peak_contact_force": lambda raw, _: _force(raw, "lowest_y"),
    "lowest_contact_force": lambda raw, _: _force(raw, "highest_y"),
    "return_peak_contact_force": lambda raw, _: 1.0 - raw.results["return_lowest_y"],
    "impact_speed": lambda raw, u: raw.results["impact_speed"] * u.speed,
    "max_displacement": lambda raw, u: np.sqrt(raw.results["largest_r2"]) * u.length,
    "early_max_x": lambda raw, u: raw.results["early_largest_x"] * u.length,
    "late_max_x": lambda raw, u: raw.results["late_largest_x"] * u.length,
    "early_max_vx": lambda raw, u: raw.results["early_largest_vx"] * u.speed,
    "late_max_vx": lambda raw, u: raw.results["late_largest_vx"] * u.speed,
    "max_vx": lambda raw, u: raw.results["largest_speed"] * u.speed,
    "nearest_pivot": lambda raw, _: np.sqrt(raw.results["nearest_pivot2"]),
    "turns": lambda raw, _: _common_turns(*raw.results["half_turns"].T),
    "separations": _count(Event.separation),
    "contacts": _count(Event.contact),
    "sticks": _count(Event.stick),
    "slips": _count(Event.slip),
    "reversals": _count(Event.reversal),
    "events": lambda raw, _: raw.results["events"],
    "steps": lambda raw, _: raw.results["steps"],
    "final_state": lambda raw, u: raw.results["final_state"] * u.state,
    "final_regime": lambda raw, _: raw.results["regime"].astype(np.int8),
    "log_growth": lambda raw, _: raw.results["log_growth"],
    "predictability_horizon": lambda raw, u: raw.results["horizon"] * u.t,
    "mark_separated_time": lambda raw, u: raw.results["mark_separated_time"] * u.t[:, None],
    "mark_stick_time": lambda raw, u: raw.results["mark_stick_time"] * u.t[:, None],
    "mark_turns": lambda raw, _: _common_turns(*np.moveaxis(raw.results["mark_half_turns"], -1, 0)),
    "mark_log_growth": lambda raw, _: raw.results["mark_growth"],
    "mark_separations": lambda raw, _: raw.results["mark_kinds"][..., Event.separation],
    "mark_contacts": lambda raw, _: raw.results["mark_kinds"][..., Event.contact],
    "mark_state": lambda raw, u: raw.results["mark_state"] * u.state[:, None],
    "samples": lambda raw, u: raw.samples * u.state[:, None],
    "sample_regimes": lambda raw, _: raw.sample_regimes.astype(np.int8),
    "event_times": lambda raw, u: raw.event_times * u.t[:, None],
    "event_kinds": lambda raw, _: raw.event_kinds.astype(np.int8),
    "event_states": lambda raw, u: raw.event_states * u.state[:, None],
}
"""Each attribute of :class:`Ensemble` from the kernel's records, in the caller's units."""
