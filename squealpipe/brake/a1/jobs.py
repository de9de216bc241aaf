"""The runs of an ensemble of A1: checked inputs, broadcast, in SI units."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BeforeValidator

from squealpipe.brake.a1.parameter_sets import parameter_sets
from squealpipe.brake.models.refusals import WHY_A4, refuse_extensions
from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.systems.system import System
from squealpipe.validation import Extended, Tolerance, checked, one_of, real_array

Model = Annotated[str, one_of(VARIANT_RULES)]
"""A nonlinear model, or a variant of it."""


def _fields(value: Any) -> Any:
    if not isinstance(value, Parameters | Mapping):
        raise ValueError(  # noqa: TRY004 (pydantic lets other errors through)
            "Parameters(...) or a mapping of their names to arrays is needed"
        )
    return value


Fields = Annotated[Any, BeforeValidator(_fields)]
STATE = ("x", "y", "vx", "vy")


@dataclass(frozen=True)
class Jobs:
    """Runs in SI units, one row each.

    Attributes:
        systems, which: A1 with the forces of some runs, and the index of that of each.
        values: states at the start and parameters of the system by name, (runs,).
        late_from_return: late extremes begin with the first return to the belt.
        most: steps, and events, that end a run.
    """

    tol: float
    shape: tuple[int, ...]
    systems: tuple[System, ...]
    which: np.ndarray
    values: dict[str, np.ndarray]
    t_end: np.ndarray
    t_late: np.ndarray
    late_from_return: bool
    times: np.ndarray
    stop_at_first_separation: bool
    stop_at_turns: float
    most: tuple[np.ndarray, np.ndarray]

    def groups(self) -> Iterator[tuple[System, Any]]:
        """Each system and the rows of its runs."""
        for index, system in enumerate(self.systems):
            alone = len(self.systems) == 1
            yield system, slice(None) if alone else np.flatnonzero(self.which == index)

    def some(self, rows: np.ndarray) -> Self:
        """Some of the runs, in one dimension."""
        columns = ("which", "t_end", "t_late", "times")
        return replace(
            self,
            shape=rows.shape,
            values={name: column[rows] for name, column in self.values.items()},
            most=(self.most[0][rows], self.most[1][rows]),
            **{name: getattr(self, name)[rows] for name in columns},
        )


@checked
def jobs_of(
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
    stop_at_turns: Extended = math.inf,
    t_late: Any = math.inf,
) -> Jobs:
    """Jobs whose arguments may each differ from run to run.

    ``parameters`` (values of the mapping), ``alpha1``, ``alpha2``, ``t_end`` and ``t_late`` are
    broadcast against one another.

    Args:
        parameters: ``Parameters``, or a mapping of its field names to arrays; fields left out
            take the baseline's value.
        initial_state: (x, y, vx, vy) in m and m/s, broadcast over the runs (last axis 4).
        times: instants (last axis), the same for all runs or one row per run, s, ascending.
        stop_at_first_separation: end a run there with outcome ``separated``.
        stop_at_turns: end a run at this many net turns around both fixed ends, with outcome
            ``amplitude_reached``.
        t_late: where early extremes end and late ones begin, s; "return" stands for the first
            return to the belt, and ``return_peak_contact_force`` asks for it.

    Raises:
        ValueError: an unknown model or parameter, a value that is not finite or not allowed, or
            shapes that do not broadcast.
    """
    if model == "A4" and isinstance(parameters, Parameters):
        refuse_extensions(parameters, "model A4", WHY_A4)
    sets = parameter_sets(parameters, model)
    late_from_return = isinstance(t_late, str) and t_late == "return"
    inputs = {
        "alpha1": real_array("alpha1", alpha1),
        "alpha2": real_array("alpha2", alpha2),
        "t_end": real_array("t_end", t_end),
        "t_late": real_array(
            "t_late", math.inf if late_from_return else t_late, infinite=True
        ),
    }
    state = real_array("initial_state", initial_state)
    if state.shape[-1:] != (4,):
        raise ValueError(
            f"initial_state has shape {state.shape}: x, y, vx, vy are needed last"
        )
    if not (inputs["t_end"] >= 0).all():
        raise ValueError(f"t_end = {inputs['t_end'].min()!r}: must be 0 or greater")
    arrays = (*inputs.values(), *sets.numbers.values(), sets.which)
    shapes = {array.shape for array in arrays}
    shape = np.broadcast_shapes(*shapes, state.shape[:-1])

    def flat(array: np.ndarray) -> np.ndarray:
        return _broadcast(array, shape).reshape(-1)

    values = {name: flat(numbers) for name, numbers in sets.numbers.items()}
    values |= {name: flat(inputs[name]) for name in ("alpha1", "alpha2")}
    columns = np.moveaxis(_broadcast(state, (*shape, 4)).reshape(-1, 4), -1, 0)
    values |= dict(zip(STATE, columns, strict=True))
    t_end = flat(inputs["t_end"])
    _refuse_too_long(t_end, values)
    turns = _fastest(values) * t_end
    return Jobs(
        tol=tol,
        shape=shape,
        systems=sets.systems,
        which=flat(sets.which),
        values=values,
        t_end=t_end,
        t_late=flat(inputs["t_late"]),
        late_from_return=late_from_return,
        times=_sample_times(times, shape, t_end),
        stop_at_first_separation=stop_at_first_separation,
        stop_at_turns=float(real_array("stop_at_turns", stop_at_turns, infinite=True)),
        most=(1e4 + 200 * turns, 1e3 + 20 * turns),
    )


def _fastest(values: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return a bound on the frequencies of the motion, rad/s."""
    stiffness = sum(values[name] for name in ("k1", "k2", "k3"))
    shorter = np.minimum(values["length1"], values["length2"])
    with np.errstate(all="ignore"):
        return np.asarray(
            np.sqrt(stiffness / values["mass"]) + np.abs(values["belt_speed"]) / shorter
        )


def _broadcast(array: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """``np.broadcast_to``, which a single run would pay for without need."""
    return array if array.shape == shape else np.broadcast_to(array, shape)


def _refuse_too_long(t_end: np.ndarray, values: Mapping[str, np.ndarray]) -> None:
    """Raise for runs that would not end in hours, and for units of time that overflow."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        time_unit = np.sqrt(values["mass"] / values["k1"])
        units = t_end / time_unit
    # in units of √(m/k1): a longer run takes hours, and a mistyped horizon should not start one
    longest_run = 1e9
    bad = ~((units <= longest_run) & (time_unit > 0) & np.isfinite(time_unit))
    if bad.any():
        index = np.argmax(bad)
        raise ValueError(
            f"t_end = {float(t_end[index])!r} s is {units[index]:.3g} time units "
            f"√(mass/k1) = {time_unit[index]:.3g} s; at most {longest_run:g} can be "
            "integrated: shorten t_end, or give mass and k1 in other units"
        )


def _sample_times(times: Any, shape: tuple[int, ...], t_end: np.ndarray) -> np.ndarray:
    if times is None:
        return np.zeros((t_end.size, 0))
    array = real_array("times", times)
    if array.ndim == 0:
        raise ValueError("times must be a sequence of instants")
    if array.size and not (
        (array[..., 1:] >= array[..., :-1]).all() and array.min() >= 0
    ):
        raise ValueError("times must ascend and start at 0 or later")
    rows = _broadcast(array, (*shape, array.shape[-1])).reshape(-1, array.shape[-1])
    if array.size and (rows[:, -1] > t_end).any():
        reached, end = float(rows[:, -1].max()), float(t_end.min())
        raise ValueError(f"times reach {reached!r}, beyond t_end = {end!r}")
    return np.ascontiguousarray(rows)
