"""Single runs and ensembles of a system, as labelled datasets."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.methods.taylor.scalar import numpy_function
from squealpipe.parameters import brief
from squealpipe.schema.systems import build
from squealpipe.systems import runs
from squealpipe.systems.cycles.sensitivity import sensitivities
from squealpipe.systems.trace import TIME
from squealpipe.validation import (
    NotNegative,
    Tolerance,
    Values,
    Vector,
    Workers,
    checked,
)

SAMPLES_PER_STEP, MOST_SAMPLES = 4, 20_001


@checked
def simulate(
    system: Any,
    t_end: NotNegative,
    *,
    times: Vector | None = None,
    start: Values | None = None,
    tol: Tolerance = 1e-12,
    sensitivity: Sequence[str] = (),
    **parameters: Any,
) -> xr.Dataset:
    """One run of a system, with every switch located.

    Args:
        times: instants, ascending; by default four a step of the integrator, evenly spaced.
        start: states that differ from the system's start, and ``regime`` if it is to be given.
        tol: tolerance of the Taylor integrator, relative to the states' sizes.
        sensitivity: names of parameters, and ``<state>0`` of starts, by which derivatives are
            taken, through all events.
        parameters: those that differ from the system's.

    Returns:
        Dataset over ``time`` and ``event``: each state and output, ``regime``, ``event_time``,
        ``event_kind``, ``event_regime`` (entered), ``outcome``; ``<state>_by_<name>`` (at fixed
        instants) and ``event_time_by_<name>``. Instants that the run did not reach hold NaN.
    """
    values = {
        n: runs.scalar(n, v)
        for n, v in runs.call_values(system, start, parameters).items()
    }
    regime = (start or {}).get("regime")
    if times is None:
        steps = runs.single_run(
            system, values, t_end, regime=regime, tol=tol, room=0
        ).steps
        times = np.linspace(
            0.0, t_end, int(np.clip(SAMPLES_PER_STEP * steps, 2, MOST_SAMPLES))
        )
    elif times[0] < 0.0 or times[-1] > t_end or (np.diff(times) < 0.0).any():
        raise ValueError(
            f"times = {brief(times)}: they must ascend from 0 to t_end = {t_end!r}"
        )
    run = runs.single_run(system, values, t_end, regime=regime, times=times, tol=tol)
    kinds = dict(enumerate(system.traced.kinds))
    names = dict(enumerate(system.regimes))
    found: dict[str, Any] = {
        name: ("time", run.path[:, i], runs.labels(f"state {name}", system.units[name]))
        for i, name in enumerate(system.states)
    }
    found |= _outputs_along(system, values, times, run)
    found["regime"] = runs.regime_flag(system, "regime", ("time",), run.path_regimes)
    found["event_time"] = ("event", run.times, runs.labels("time of the event", "s"))
    found["event_kind"] = runs.flag("kind of the event", "event", run.kinds, kinds)
    found["event_regime"] = runs.flag("regime entered", "event", run.entered, names)
    found["outcome"] = runs.outcome(system, (), run.outcome)
    found["end_time"] = ((), run.reached, runs.labels("time reached", "s"))
    if sensitivity:
        found |= sensitivities(system, sensitivity, values, run, times)
    coordinates = {
        "time": ("time", times, runs.labels("time", "s")),
        **runs.components_of(system),
    }
    attributes = runs.attributes(system, "simulate", values, tol)
    return build("simulate", found, coordinates, attributes)


def _outputs_along(
    system: Any, values: Mapping[str, float], times: np.ndarray, run: runs.Motion
) -> dict[str, Any]:
    """Each output at the instants of a run, with the constants of its regimes there."""
    traced = system.traced
    function, names = numpy_function(list(traced.outputs))
    known: dict[str, Any] = {**values, TIME: times}
    known |= dict(zip(system.states, run.path.T, strict=True))
    for component, regimes in enumerate(run.path_regimes.T):
        columns = traced.columns(component)
        # where the run did not come the states are NaN, whatever the regime
        held = traced.regimes[np.maximum(regimes, 0), columns].T
        known |= dict(zip(traced.constants[columns], held, strict=True))
    along = function(*(known[name] for name in names))
    reached = np.where(run.path_regimes[:, 0] >= 0, 0.0, np.nan)
    return {
        name: ("time", value + reached, runs.labels(f"output {name}", unit))
        for (name, (unit, _)), value in zip(system.outputs.items(), along, strict=True)
    }


@checked
def ensemble(
    system: Any,
    t_end: NotNegative,
    *,
    start: Values | None = None,
    t_late: NotNegative | None = None,
    tol: Tolerance = 1e-12,
    horizon: bool = False,
    workers: Workers = None,
    **parameters: Any,
) -> xr.Dataset:
    """Many runs: an outer product over all starts and parameters that are given as 1-D arrays.

    Args:
        start: states that differ from the system's start, and ``regime`` if it is to be given; an
            array of ``x`` has dimension ``x0``.
        t_late: from when the ``late_…`` extremes are kept; 0.8 t_end by default.
        horizon: with the growth of a perturbation and the horizon of predictability.
        workers: processes; None takes all cores. The result is the same bit for bit.
        parameters: those that differ from the system's.

    Returns:
        Dataset over the arrays' dimensions, starts first: final states, ``<name>_min``,
        ``<name>_max``, ``late_<name>_min``, ``late_<name>_max`` of states and outputs,
        ``count_<event>``, ``first_<event>`` (NaN: never), ``time_in_<regime>``, ``outcome``.
    """
    grid = runs.outer_product(system, start, parameters)
    shape, size = grid.shape, math.prod(grid.shape)
    late = 0.8 * t_end if t_late is None else t_late
    if late > t_end:
        raise ValueError(
            f"t_late = {t_late!r}: a time up to t_end = {t_end!r} is needed"
        )
    raw = runs.integrate(
        system,
        grid.values,
        np.full(size, t_end),
        t_late=late,
        tol=tol,
        tangent=horizon,
        regime=grid.regime,
        workers=workers,
    )
    over = tuple(grid.coordinates)

    def field(long_name: str, units: str, array: np.ndarray) -> Any:
        return over, array.reshape(shape), runs.labels(long_name, units)

    found: dict[str, Any] = {}
    units = {
        **system.units,
        **{name: unit for name, (unit, _) in system.outputs.items()},
    }
    for i, name in enumerate(system.states):
        found[name] = field(f"{name} at the end", units[name], raw["final"][:, i])
    for i, name in enumerate(units):
        for j, which in enumerate(("_min", "_max")):
            label = f"{('smallest', 'largest')[j]} {name}"
            found[name + which] = field(label, units[name], raw["extremes"][:, i, j])
            late_one = raw["late_extremes"][:, i, j]
            reached = np.where(
                np.isfinite(late_one), late_one, np.nan
            )  # the outcome says why
            found[f"late_{name}{which}"] = field(
                f"{label} from t_late on", units[name], reached
            )
    for i, name in enumerate(system.traced.kinds):
        found[f"count_{name}"] = field(
            f"number of events {name}", "1", raw["counts"][:, i]
        )
        found[f"first_{name}"] = field(
            f"time of the first {name}", "s", raw["firsts"][:, i]
        )
    for i, name in enumerate(system.regimes):
        found[f"time_in_{name}"] = field(
            f"time in regime {name}", "s", raw["durations"][:, i]
        )
    if horizon:
        with np.errstate(all="ignore"):  # NaN of a run that ended where it began
            rate = np.where(
                raw["summary"][:, 2],
                raw["summary"][:, 0] / raw["summary"][:, 2],
                np.nan,
            )
        found["lyapunov_exponent"] = field("growth rate of a perturbation", "s-1", rate)
        found["predictability_horizon"] = field(
            "time at which an error of tol is lost", "s", raw["summary"][:, 1]
        )
    found["outcome"] = runs.outcome(system, over, raw["ends"][:, 0].reshape(shape))
    attributes = runs.attributes(system, "ensemble", grid.fixed, tol)
    return build("ensemble", found, grid.coordinates, attributes)
