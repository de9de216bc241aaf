"""Ensembles of nonlinear runs: any number of lanes, each with its own parameters and angles."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.methods.lanes import LANES, Workspace, drive
from squealpipe.methods.processes import run_shared
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.tasks import lane_kernel as kernel
from squealpipe.tasks.a1_system import lane_integrator
from squealpipe.tasks.lane_kernel import lane_kernel

PARAMETER_NAMES = tuple(name for name in Parameters.__dataclass_fields__ if name != "sigma")

LOST_ERROR = 1e-3
"""Error, in l_pre, from which a state says nothing about its run."""


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
    jobs = _Jobs.build(
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
        "results": ((size, kernel.N_RESULTS), np.float64),
        "counts": ((size, kernel.N_COUNTS), np.int64),
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
    return jobs.results(arrays)


def _run_lanes(
    integrator: Any, jobs: _Jobs, arrays: dict[str, np.ndarray], first: int, stride: int
) -> None:
    """Run the jobs first, first + stride, … in one process."""
    for name, fill in (("samples", np.nan), ("event_times", np.nan), ("event_states", np.nan)):
        arrays[name][first::stride] = fill
    for name in ("sample_regimes", "event_kinds"):
        arrays[name][first::stride] = -1
    memory = np.zeros((LANES, kernel.N_MEMORY))
    integers = np.full((LANES, kernel.N_INTEGERS), kernel.EMPTY, np.int64)
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


@dataclass(frozen=True)
class _Jobs:
    """Runs in units of m = k1 = l_pre = 1, one row each, and the units to go back."""

    shape: tuple[int, ...]
    orders: np.ndarray
    initial: np.ndarray
    times: np.ndarray
    time_unit: np.ndarray
    length: np.ndarray

    @classmethod
    def build(
        cls,
        parameters: Parameters | Mapping[str, Any],
        alpha1: Any,
        alpha2: Any,
        *,
        t_end: Any,
        model: str,
        tol: float,
        initial_state: Any,
        times: Any,
        stop_at_first_separation: bool,
        stop_at_x: Any,
        stop_at_turns: float,
        t_late: Any,
    ) -> _Jobs:
        rules = VARIANT_RULES[known_model(model)]
        if not (isinstance(tol, float) and 1e-18 < tol < 1e-2):
            raise ValueError(f"tol = {tol!r}: a number between 1e-18 and 1e-2 is needed")
        physical = _parameter_arrays(parameters)
        inputs = {
            **physical,
            "alpha1": real_array("alpha1", alpha1),
            "alpha2": real_array("alpha2", alpha2),
            "t_end": real_array("t_end", t_end),
            "stop_at_x": real_array("stop_at_x", stop_at_x, infinite=True),
            "t_late": real_array("t_late", t_late, infinite=True),
        }
        state = real_array("initial_state", initial_state)
        if state.shape[-1:] != (4,):
            raise ValueError(f"initial_state has shape {state.shape}: x, y, vx, vy are needed last")
        if not (inputs["t_end"] >= 0).all():
            raise ValueError(f"t_end = {inputs['t_end'].min()!r}: must be 0 or greater")
        shape = np.broadcast_shapes(*(array.shape for array in inputs.values()), state.shape[:-1])
        flat = {name: np.broadcast_to(array, shape).ravel() for name, array in inputs.items()}
        time_unit = np.sqrt(flat["mass"] / flat["k1"])
        length = flat["preload"].copy()
        speed_unit = length / time_unit
        orders = np.zeros((time_unit.size, kernel.N_ORDERS))
        cosines = [
            function(flat[angle]) for angle in ("alpha1", "alpha2") for function in (np.cos, np.sin)
        ]
        rows = (
            flat["k2"] / flat["k1"],
            flat["k3"] / flat["k1"],
            flat["mu"],
            flat["belt_speed"] / speed_unit,
            flat["length1"] / length,
            flat["length2"] / length,
            *cosines,
            flat["t_end"] / time_unit,
            flat["t_late"] / time_unit,
            flat["stop_at_x"] / length,
        )
        for column, values in enumerate(rows):
            orders[:, column] = values
        k2, k3, _, speed, length1, length2 = (orders[:, i] for i in range(6))
        rate = np.sqrt(1 + k2 + k3) + np.abs(speed) / np.minimum(length1, length2)
        orders[:, kernel.STOP_AT_SEPARATION] = stop_at_first_separation
        orders[:, kernel.STOP_AT_TURNS] = stop_at_turns
        orders[:, kernel.MAX_STEPS] = 1e4 + 200 * rate * orders[:, kernel.T_END]
        orders[:, kernel.MAX_EVENTS] = 1e3 + 20 * rate * orders[:, kernel.T_END]
        orders[:, kernel.LOST_GROWTH] = math.log(LOST_ERROR / tol)
        orders[:, kernel.SEPARATES] = rules.separates
        orders[:, kernel.REVERSES] = rules.reverses
        orders[:, kernel.STICKS] = rules.sticks
        orders[:, kernel.LINEAR_SPRINGS] = rules.linear_springs
        initial = np.broadcast_to(state, (*shape, 4)).reshape(-1, 4)
        scale = np.stack([length, length, speed_unit, speed_unit], axis=-1)
        return cls(
            shape=shape,
            orders=orders,
            initial=np.ascontiguousarray(initial / scale),
            times=_sample_times(times, shape, flat["t_end"], time_unit),
            time_unit=time_unit,
            length=length,
        )

    def results(self, arrays: dict[str, np.ndarray]) -> Ensemble:
        """Results in the caller's units and shape."""
        result, count = arrays["results"].T, arrays["counts"].T
        t, length = self.time_unit, self.length
        speed = length / t
        scale = np.stack([length, length, speed, speed], axis=-1)[:, None, :]
        separated = result[kernel.LOWEST_Y] == np.inf
        flat = {
            "outcome": count[kernel.OUTCOME].astype(np.int8),
            "time": result[kernel.TIME] * t,
            "first_separation_time": result[kernel.FIRST_SEPARATION] * t,
            "separated_time": result[kernel.SEPARATED_TIME] * t,
            "stick_time": result[kernel.STICK_TIME] * t,
            "peak_contact_force": np.where(separated, 0.0, 1.0 - result[kernel.LOWEST_Y]),
            "lowest_contact_force": np.where(separated, 0.0, 1.0 - result[kernel.HIGHEST_Y]),
            "max_displacement": np.sqrt(result[kernel.LARGEST_R2]) * length,
            "early_max_x": result[kernel.EARLY_LARGEST_X] * length,
            "late_max_x": result[kernel.LATE_LARGEST_X] * length,
            "max_vx": result[kernel.LARGEST_SPEED] * speed,
            "nearest_pivot": np.sqrt(result[kernel.NEAREST_PIVOT2]),
            "turns": _common_turns(result[kernel.HALF_TURNS1], result[kernel.HALF_TURNS2]),
            "separations": count[kernel.FIRST_KIND],
            "contacts": count[kernel.FIRST_KIND + 1],
            "sticks": count[kernel.FIRST_KIND + 2],
            "slips": count[kernel.FIRST_KIND + 3],
            "reversals": count[kernel.FIRST_KIND + 4],
            "steps": count[kernel.STEPS],
            "final_state": result[kernel.FINAL_STATE :].T * scale[:, 0],
            "final_regime": count[kernel.REGIME].astype(np.int8),
            "log_growth": result[kernel.LOG_GROWTH],
            "predictability_horizon": result[kernel.HORIZON] * t,
            "samples": arrays["samples"] * scale,
            "sample_regimes": arrays["sample_regimes"].astype(np.int8),
            "event_times": arrays["event_times"] * t[:, None],
            "event_kinds": arrays["event_kinds"].astype(np.int8),
            "event_states": arrays["event_states"] * scale,
        }
        return Ensemble(
            **{name: values.reshape(self.shape + values.shape[1:]) for name, values in flat.items()}
        )


def _common_turns(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Turns around both points from half turns around each; 0 where they turn against another."""
    least = np.minimum(np.abs(first), np.abs(second))
    return np.where(first * second > 0, 0.5 * np.sign(first) * least, 0.0)


def known_model(model: str) -> str:
    """The model's name.

    Raises:
        ValueError: it is unknown; the nearest name is suggested.
    """
    if not isinstance(model, str) or model not in VARIANT_RULES:
        near = difflib.get_close_matches(str(model), VARIANT_RULES, n=1, cutoff=0.0)
        raise ValueError(
            f"model = {model!r}: unknown; did you mean {near[0]!r}? known: "
            + ", ".join(VARIANT_RULES)
        )
    return model


def real_array(name: str, values: Any, *, infinite: bool = False) -> np.ndarray:
    """A float array.

    Raises:
        ValueError: text, NaN or (unless allowed) infinity, with the name and the first culprit.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} = {values!r}: numbers are needed, not {array.dtype}")
    array = array.astype(float)
    bad = np.isnan(array) if infinite else ~np.isfinite(array)
    if bad.any():
        raise ValueError(f"{name} holds {array[bad].flat[0]!r}: finite numbers are needed")
    return array


def _parameter_arrays(parameters: Parameters | Mapping[str, Any]) -> dict[str, np.ndarray]:
    if isinstance(parameters, Parameters):
        given: dict[str, Any] = {name: getattr(parameters, name) for name in PARAMETER_NAMES}
    else:
        given = {name: getattr(Parameters, name) for name in PARAMETER_NAMES}
        for name, values in parameters.items():
            if name not in Parameters.__dataclass_fields__:
                near = difflib.get_close_matches(str(name), PARAMETER_NAMES, n=1, cutoff=0.0)
                raise ValueError(f"unknown parameter {name!r}; did you mean {near[0]!r}?")
            if name != "sigma":
                given[name] = values
    arrays = {name: real_array(name, values) for name, values in given.items()}
    for name, array in arrays.items():
        if name == "mu" and not (array >= 0).all():
            raise ValueError(f"mu holds {array.min()!r}: must be 0 or greater")
        if name not in {"mu", "belt_speed"} and not (array > 0).all():
            raise ValueError(f"{name} holds {array.min()!r}: must be greater than 0")
    return arrays


def _sample_times(
    times: Any, shape: tuple[int, ...], t_end: np.ndarray, time_unit: np.ndarray
) -> np.ndarray:
    if times is None:
        return np.zeros((time_unit.size, 0))
    array = real_array("times", times)
    if array.ndim == 0:
        raise ValueError("times must be a sequence of instants")
    rows = np.broadcast_to(array, (*shape, array.shape[-1])).reshape(-1, array.shape[-1])
    if array.size and not ((np.diff(rows) >= 0).all() and (rows[:, 0] >= 0).all()):
        raise ValueError("times must ascend and start at 0 or later")
    if array.size and (rows[:, -1] > t_end).any():
        raise ValueError(f"times reach {rows[:, -1].max()!r}, beyond t_end = {t_end.min()!r}")
    return np.ascontiguousarray(rows / time_unit[:, None])
