"""Single runs and ensembles of a system, as labelled datasets."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.systems.cycles.sensitivity import sensitivities
from squealpipe.systems.grid import call_values, duration_of, outer_product, scalar
from squealpipe.systems.inputs.gate import (
    Natural,
    Number,
    Tolerance,
    Values,
    Vector,
    Workers,
    checked,
)
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.integrate import MOST_STEPS, RunOptions, integrate
from squealpipe.systems.labels import build, named, outcome, regime_flag
from squealpipe.systems.record import FIRST_LOG, RunRecord, single_run


@checked
def simulate(
    system: Any,
    t_end: Number,
    *,
    t_start: Number = 0.0,
    times: Vector | None = None,
    start: Values | None = None,
    tol: Tolerance = 1e-12,
    max_steps: Natural = MOST_STEPS,
    sensitivity: Sequence[str] = (),
    **parameters: Any,
) -> xr.Dataset:
    """Run a system once, and locate every switch.

    Args:
        t_end: time at which it ends, s.
        t_start: time at which it begins, s.
        times: instants of the answer, ascending, s; by default evenly spaced, about four for each
            step of the integrator.
        start: states that differ from the system's start, and ``regime`` if it is to be given.
        tol: tolerance of the Taylor integrator, relative to the states' sizes.
        max_steps: steps of the integrator in a run, after which its outcome is ``step_limit``.
        sensitivity: names of parameters, and ``<state>0`` of starts, by which derivatives are
            taken, through all events.
        parameters: those that differ from the system's.

    Returns:
        Dataset over ``time`` and ``event``: each state and output, ``regime``, ``event_time``,
        ``event_kind``, ``event_regime`` (entered), ``end_time`` and ``outcome``; with
        ``sensitivity`` also ``<state>_by_<name>`` (at fixed instants) and ``event_time_by_<name>``.
        Instants that the run did not reach hold NaN.
    """
    values = {
        n: scalar(n, v) for n, v in call_values(system, start, parameters).items()
    }
    duration = duration_of(t_start, t_end)
    options = RunOptions(
        regime=(start or {}).get("regime"), t_start=t_start, most_steps=max_steps
    )
    room = FIRST_LOG
    if times is None:
        ahead = single_run(system, values, duration, options, tol=tol, room=0)
        steps, room = ahead.steps, max(ahead.n_events, 1)
        # four samples in each step show every curve of a run
        times = np.linspace(t_start, t_end, int(np.clip(4 * steps, 2, 20_001)))
    elif times[0] < t_start or times[-1] > t_end or (np.diff(times) < 0.0).any():
        raise ValueError(
            f"times = {brief(times)}: they must ascend from {t_start:g} to t_end = {t_end!r}"
        )
    options = replace(options, times=times - t_start)
    run = single_run(system, values, duration, options, tol=tol, room=room)
    # not one round-off before the end
    reached = t_end if run.reached == duration else run.reached + t_start
    run = replace(run, times=run.times + t_start, reached=reached)
    content: dict[str, Any] = {
        "<name>": dict(zip(system.states, run.path.T, strict=True))
        | _outputs_along(system, values, times, run),
        "regime": regime_flag(system, run.path_regimes),
        "event_time": run.times,
        "event_kind": named(run.kinds, dict(enumerate(system.traced.kinds))),
        "event_regime": named(run.entered, dict(enumerate(system.regimes))),
        "outcome": outcome(system, run.outcome),
        "end_time": run.reached,
    }
    if sensitivity:
        content |= sensitivities(system, sensitivity, values, run, times, t_start)
    return build(system, "simulate", content, {"time": times}, values, tol)


def _outputs_along(
    system: Any, values: Mapping[str, float], times: np.ndarray, run: RunRecord
) -> dict[str, Any]:
    """Return each output at the instants of a run, with the constants of the regime there."""
    along = system.outputs_along(values, times, run.path, run.path_regimes)
    reached = np.where(run.path_regimes[:, 0] >= 0, 0.0, np.nan)
    return {
        name: value + reached for name, value in zip(system.outputs, along, strict=True)
    }


@checked
def ensemble(
    system: Any,
    t_end: Number,
    *,
    t_start: Number = 0.0,
    start: Values | None = None,
    t_late: Number | None = None,
    tol: Tolerance = 1e-12,
    max_steps: Natural = MOST_STEPS,
    horizon: bool = False,
    workers: Workers = None,
    **parameters: Any,
) -> xr.Dataset:
    """Run a system for all combinations of the starts and parameters that are 1-D arrays.

    Args:
        t_end: time at which they end, s.
        t_start: time at which they begin, s.
        start: states that differ from the system's start, and ``regime`` if it is to be given; an
            array of ``x`` has dimension ``x0``.
        t_late: time from which the ``late_…`` extremes count, s; by default after four fifths of
            the run.
        max_steps: steps of the integrator in a run, after which its outcome is ``step_limit``.
        horizon: whether ``lyapunov_exponent``, the growth rate of a perturbation, 1/s, and
            ``predictability_horizon``, s, are wanted.
        workers: processes; None takes all cores. The result is the same bit for bit.
        parameters: those that differ from the system's.

    Returns:
        Dataset over the arrays' dimensions, starts first: final states, ``<name>_min``,
        ``<name>_max``, ``late_<name>_min``, ``late_<name>_max`` of states and outputs,
        ``count_<event>``, ``first_<event>`` (NaN: never), ``time_in_<regime>``, ``outcome``.
    """
    grid = outer_product(system, start, parameters)
    size = math.prod(grid.shape)
    duration = duration_of(t_start, t_end)
    late = 0.8 * duration if t_late is None else t_late - t_start
    if not 0.0 <= late <= duration:
        raise ValueError(
            f"t_late = {t_late!r}: a time from {t_start:g} to t_end = {t_end!r} is needed"
        )
    raw = integrate(
        system,
        grid.values,
        np.full(size, duration),
        RunOptions(
            regime=grid.regime,
            t_late=late,
            tangent=horizon,
            t_start=t_start,
            most_steps=max_steps,
        ),
        tol=tol,
        workers=workers,
    )
    names = [*system.states, *system.outputs]
    # infinite where there was none: not reached, or an output that never was a number
    extremes = {
        f"{late}<name>_{end}": dict(
            zip(names, np.where(np.isfinite(each), each, np.nan).T, strict=True)
        )
        for late in ("", "late_")
        for end, each in zip(
            ("min", "max"), np.moveaxis(raw[f"{late}extremes"], -1, 0), strict=True
        )
    }
    kinds, regimes = system.traced.kinds, system.regimes
    content: dict[str, Any] = {
        "<state>": dict(zip(system.states, raw["final"].T, strict=True)),
        **extremes,
        "count_<event>": dict(zip(kinds, raw["counts"].T, strict=False)),
        "first_<event>": dict(zip(kinds, raw["firsts"].T + t_start, strict=False)),
        "time_in_<regime>": dict(zip(regimes, raw["durations"].T, strict=False)),
        "outcome": outcome(system, raw["outcome"]),
    }
    if horizon:
        with np.errstate(all="ignore"):  # NaN of a run that ended where it began
            rate = np.where(raw["reached"], raw["log_growth"] / raw["reached"], np.nan)
        content["lyapunov_exponent"] = rate
        content["predictability_horizon"] = raw["horizon"] + t_start
    return build(system, "ensemble", content, grid.coordinates, grid.fixed, tol)
