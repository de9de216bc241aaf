"""The runs of an ensemble: checked inputs, broadcast, in units of m = k1 = l_pre = 1."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from squealpipe.laws import springs
from squealpipe.models.refusals import WHY_A4, refuse_extensions
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.solvers.a1.own_laws import OwnLaws, split
from squealpipe.solvers.a1.scaling import scaled_parameters
from squealpipe.solvers.a1.system import DISSIPATIONS, Dissipation
from squealpipe.validation import one_of, real_array

Model = Annotated[str, one_of(VARIANT_RULES)]
"""A nonlinear model, or a variant of it."""
MOST_TIME_UNITS = 1e9
"""Longest run; beyond it, one takes hours."""

LOST_ERROR = 1e-3
"""Error, in l_pre, from which a state says nothing about its run."""


@dataclass(frozen=True)
class Jobs:
    """Runs in units of m = k1 = l_pre = 1, one row each, and the units to go back."""

    model: str
    tol: float
    shape: tuple[int, ...]
    orders: np.ndarray
    initial: np.ndarray
    times: np.ndarray
    time_unit: np.ndarray
    length: np.ndarray
    dissipation: np.ndarray
    own: OwnLaws | None = None

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
        stop_at_first_separation: bool = False,
        stop_at_x: Any = math.inf,
        stop_at_turns: float = math.inf,
        t_late: Any = math.inf,
    ) -> Jobs:
        """Jobs from the arguments of :func:`squealpipe.solvers.a1.ensemble.run_ensemble`."""
        rules = VARIANT_RULES[model]
        parameters, own = split(parameters, model)
        physical = scaled_parameters(parameters, linear_springs=rules.linear_springs)
        inputs = {
            "alpha1": real_array("alpha1", alpha1),
            "alpha2": real_array("alpha2", alpha2),
            "t_end": real_array("t_end", t_end),
            "stop_at_x": real_array("stop_at_x", stop_at_x, infinite=True),
            "t_late": real_array("t_late", t_late, infinite=True),
            "stop_at_turns": real_array("stop_at_turns", stop_at_turns, infinite=True),
        }
        state = real_array("initial_state", initial_state)
        if state.shape[-1:] != (4,):
            raise ValueError(f"initial_state has shape {state.shape}: x, y, vx, vy are needed last")
        if not (inputs["t_end"] >= 0).all():
            raise ValueError(f"t_end = {inputs['t_end'].min()!r}: must be 0 or greater")
        shapes = {array.shape for array in inputs.values()}
        shape = np.broadcast_shapes(physical.time_unit.shape, *shapes, state.shape[:-1])

        def flat(array: np.ndarray) -> np.ndarray:
            return _spread(array, shape).reshape(-1)

        time_unit, ends = flat(physical.time_unit), flat(inputs["t_end"])
        _refuse_too_long(ends, time_unit)
        length, dissipation = flat(physical.length), flat(physical.dissipation)
        if model == "A4" and isinstance(parameters, Parameters):
            refuse_extensions(parameters, "model A4", WHY_A4)
        if model == "A4" and dissipation.any():
            raise ValueError(f"model A4 carries no damping and Coulomb's law with one μ: {WHY_A4}")
        orders = flat(physical.orders).copy()
        if not rules.drags:
            for name in ("mu", "static_mu", "onset_mu"):
                orders[name] *= -1.0
        t_end, rate = ends / time_unit, flat(physical.rate)
        for name, values in {
            **springs.geometry(flat(inputs["alpha1"]), flat(inputs["alpha2"]))._asdict(),
            **rules._asdict(),
            "t_end": t_end,
            "t_late": flat(inputs["t_late"]) / time_unit,
            "stop_at_x": flat(inputs["stop_at_x"]) / length,
            "stop_at_separation": stop_at_first_separation,
            "stop_at_turns": flat(inputs["stop_at_turns"]),
            "lost_growth": math.log(LOST_ERROR / tol),
            "max_steps": 1e4 + 200 * rate * t_end,
            "max_events": 1e3 + 20 * rate * t_end,
        }.items():
            orders[name] = values
        if own is not None:
            own = replace(own, alpha1=flat(inputs["alpha1"]), alpha2=flat(inputs["alpha2"]))
        initial = _spread(state, (*shape, 4)).reshape(-1, 4)
        speed_unit = length / time_unit
        scale = np.array([length, length, speed_unit, speed_unit]).T
        return cls(
            model=model,
            tol=tol,
            shape=shape,
            orders=orders,
            initial=np.ascontiguousarray(initial / scale),
            times=_sample_times(times, shape, ends, time_unit),
            time_unit=time_unit,
            length=length,
            dissipation=dissipation,
            own=own,
        )

    def groups(self) -> dict[Dissipation, np.ndarray]:
        """Rows of the runs of each system that is to be compiled."""
        return {
            DISSIPATIONS[code]: np.flatnonzero(self.dissipation == code)
            for code in sorted(set(self.dissipation.tolist())) or [0]
        }

    def subset(self, rows: np.ndarray) -> Jobs:
        """Some of the runs."""
        per_run = ("orders", "initial", "times", "time_unit", "length", "dissipation")
        chosen = {name: getattr(self, name)[rows] for name in per_run}
        return replace(self, shape=rows.shape, **chosen)


def _spread(array: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """``np.broadcast_to``, which a single run would pay for without need."""
    return array if array.shape == shape else np.broadcast_to(array, shape)


def _refuse_too_long(t_end: np.ndarray, time_unit: np.ndarray) -> None:
    """Raise for runs that would not end in hours, and for units of time that overflow."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        units = t_end / time_unit
    bad = ~((units <= MOST_TIME_UNITS) & (time_unit > 0) & np.isfinite(time_unit))
    if bad.any():
        index = np.argmax(bad)
        raise ValueError(
            f"t_end = {float(t_end[index])!r} s is {units[index]:.3g} time units "
            f"√(mass/k1) = {time_unit[index]:.3g} s; at most {MOST_TIME_UNITS:g} can be "
            "integrated: shorten t_end, or give mass and k1 in other units"
        )


def _sample_times(
    times: Any, shape: tuple[int, ...], t_end: np.ndarray, time_unit: np.ndarray
) -> np.ndarray:
    if times is None:
        return np.zeros((time_unit.size, 0))
    array = real_array("times", times)
    if array.ndim == 0:
        raise ValueError("times must be a sequence of instants")
    if array.size and not ((array[..., 1:] >= array[..., :-1]).all() and array.min() >= 0):
        raise ValueError("times must ascend and start at 0 or later")
    rows = _spread(array, (*shape, array.shape[-1])).reshape(-1, array.shape[-1])
    if array.size and (rows[:, -1] > t_end).any():
        raise ValueError(f"times reach {rows[:, -1].max()!r}, beyond t_end = {t_end.min()!r}")
    return np.ascontiguousarray(rows / time_unit[:, None])
