"""The runs of an ensemble: checked inputs, broadcast, in units of m = k1 = l_pre = 1."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.tasks import lane_layout as layout

PARAMETER_NAMES = tuple(name for name in Parameters.__dataclass_fields__ if name != "sigma")

LOST_ERROR = 1e-3
"""Error, in l_pre, from which a state says nothing about its run."""


@dataclass(frozen=True)
class Jobs:
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
    ) -> Jobs:
        """Jobs from the arguments of :func:`squealpipe.tasks.ensemble.run_ensemble`."""
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
        orders = np.zeros((time_unit.size, layout.N_ORDERS))
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
        orders[:, layout.STOP_AT_SEPARATION] = stop_at_first_separation
        orders[:, layout.STOP_AT_TURNS] = stop_at_turns
        orders[:, layout.MAX_STEPS] = 1e4 + 200 * rate * orders[:, layout.T_END]
        orders[:, layout.MAX_EVENTS] = 1e3 + 20 * rate * orders[:, layout.T_END]
        orders[:, layout.LOST_GROWTH] = math.log(LOST_ERROR / tol)
        orders[:, layout.SEPARATES] = rules.separates
        orders[:, layout.REVERSES] = rules.reverses
        orders[:, layout.STICKS] = rules.sticks
        orders[:, layout.LINEAR_SPRINGS] = rules.linear_springs
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
