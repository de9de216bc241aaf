"""Any task over ranges of parameters, angles and options, as one labelled dataset."""

from __future__ import annotations  # help shows Angle, not its checks

import inspect
import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from squealpipe.brake.models.refusals import refuse_unread
from squealpipe.brake.sampling import default_times
from squealpipe.inputs import ANGLES
from squealpipe.parameters import Parameters, parameters_of
from squealpipe.ranges import NUMERIC_PARAMETERS, PARAMETER_NAMES, is_structure
from squealpipe.schema import (
    ABSENT,
    DatasetSchema,
    Outcome,
    Variable,
    build,
    find,
    meanings,
)
from squealpipe.schema.origin import origin
from squealpipe.study.chunks import Chunks, Run
from squealpipe.study.operating_sweep import TASK as OPERATING_MAP
from squealpipe.study.operating_sweep import OperatingSweep
from squealpipe.study.point_sweep import PointSweep
from squealpipe.study.scatter import join
from squealpipe.study.schema.sweep import (
    OPTIONS,
    fill_up,
    is_ragged,
    ragged_dims,
    sweep_name,
)
from squealpipe.study.structure_sweep import StructureSweep
from squealpipe.study.sweep_plan import SweepPlan
from squealpipe.study.swept_tasks import MAPS, TASKS, options_of
from squealpipe.study.system_sweep import SystemSweep, is_system
from squealpipe.systems.inputs.units import holds_units
from squealpipe.systems.inputs.words import suggestion
from squealpipe.validation import Line, Workers, checked


@checked
def _gate(
    task: str,  # noqa: ARG001 (its type is checked)
    params: Parameters,  # noqa: ARG001
    vary: Mapping[str, Line],
    fixed: Mapping[str, Any],
) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """Return what varies and what is fixed, in SI; the types of all fields are checked."""
    return vary, fixed


@dataclass(frozen=True, kw_only=True)
class Sweep(PointSweep):
    """A sweep: a task, fixed arguments, and the values of those that vary.

    Attributes:
        task: name of the task, for instance ``"periodic_orbit"``.
        params: parameters where they are neither varied nor fixed.
        vary: name → values; names are parameters, ``alpha1``, ``alpha2`` or options of the task.
        fixed: angles, parameters and options that stay the same. Where a task has an option of a
            parameter's name (``sigma`` of ``backbone``), the option is meant.

    Raises:
        ValueError: an unknown task or name, no values, a parameter that is not allowed, or an
            angle that is missing.
    """

    params: Parameters

    def __post_init__(self) -> None:
        self._read_units()
        if self.task not in TASKS:
            raise ValueError(f"no task {self.task!r}; {suggestion(self.task, TASKS)}")
        options = options_of(self.task)
        varied = [
            *NUMERIC_PARAMETERS,
            *ANGLES,
            *(name for name in options if name in OPTIONS),
        ]
        for name, values in self.vary.items():
            if name not in varied:
                near = suggestion(name, varied)
                raise ValueError(f"{name!r} cannot be varied for {self.task}; {near}")
            if not len(values) or len(set(values)) != len(values):
                raise ValueError(
                    f"{name} needs one or more values, each once, not {values!r}"
                )
            for value in values:
                self._with({name: value})
        for name in set(self.fixed) - {*ANGLES, *options, *PARAMETER_NAMES}:
            known = ", ".join(options) or "none"
            raise ValueError(f"{self.task} has no option {name!r}; it has {known}")
        self._with(self.fixed)
        no_default = inspect.Parameter.empty
        needed = {*ANGLES, *(name for name in options if options[name] is no_default)}
        for name in sorted(needed | (set(self.vary) & set(self.fixed))):
            if (name in self.vary) == (name in self.fixed):
                raise ValueError(f"{self.task} needs {name} once, fixed or varied")
        if not self.names:
            raise ValueError(
                f"nothing to sweep: {self.task} maps both angles by itself; vary a parameter too"
            )
        # a table of contact is read anew at the preload of each run
        params, _ = self._with(self.fixed)
        ranges = {*self.vary} & {*NUMERIC_PARAMETERS} - {"preload", *options}
        refuse_unread(params, sorted(ranges))
        self._refuse_other_times()

    def _read_units(self) -> None:
        """Check the types of all fields, and have values with units in SI."""
        vary, fixed = _gate(self.task, self.params, self.vary, self.fixed)
        if holds_units([*self.vary.values(), *self.fixed.values()]):
            plain = {name: np.asarray(each).tolist() for name, each in vary.items()}
            object.__setattr__(self, "vary", plain)
            object.__setattr__(self, "fixed", fixed)

    def _with(self, values: Mapping[str, Any]) -> tuple[Parameters, dict[str, Any]]:
        """Return the parameters with those among the values, and the rest: angles and options."""
        options = options_of(self.task)
        physical = {
            name for name in values if name in PARAMETER_NAMES and name not in options
        }
        params = self.params.with_(**{name: values[name] for name in physical})
        return params, {name: values[name] for name in values if name not in physical}

    def _refuse_other_times(self) -> None:
        """Raise if runs end at other times, before any is made; one name is changed at a time."""
        if self.task != "simulate" or self.fixed.get("times") is not None:
            return
        points = [{name: values[0] for name, values in self.vary.items()}]
        points += [
            {**points[0], name: value}
            for name, values in self.vary.items()
            for value in values
        ]
        first = None
        for point in points:
            params, options = self._with({**self.fixed, **point})
            times = default_times(params, options["t_end"])
            first = times if first is None else first
            _refuse_other("time", times, first)

    @property
    def names(self) -> list[str]:
        """Swept names in the order given; angles that the task itself maps are not among them."""
        inner = ("alpha1", "alpha2") if TASKS[self.task] in MAPS else ()
        return [name for name in self.vary if name not in inner]

    @property
    def points(self) -> list[tuple[float, ...]]:
        """Values of the swept names at every point, last name fastest."""
        return list(itertools.product(*(self.vary[name] for name in self.names)))

    @property
    def schema(self) -> DatasetSchema:
        """Schema of the result."""
        return find(sweep_name(_schema(self.task), self.names))

    def run(self, point: Sequence[float], workers: int | None = None) -> xr.Dataset:
        """The task at one point, in so many processes where it can use several."""
        point_by_name = dict(zip(self.names, point, strict=True))
        params, options = self._with({**self.fixed, **self.vary, **point_by_name})
        angles = [options.pop(name) for name in ANGLES]
        task = TASKS[self.task]
        if "workers" in inspect.signature(task).parameters:
            options["workers"] = workers
        if task in MAPS:
            angles = [np.atleast_1d(angle) for angle in angles]
        return task(params, *angles, **options)

    def arrays(self, point: Sequence[float], workers: int | None) -> Run:
        """A run as arrays, and its lengths along dimensions that differ from run to run."""
        run = self.run(point, workers)
        lengths = {
            f"{dim}_count": np.asarray(run.sizes.get(dim, 0))
            for dim in ragged_dims(find(_schema(self.task)))
        }
        return {
            str(name): values.values for name, values in run.variables.items()
        } | lengths

    def merged(self, runs: Callable[[], Iterator[Run]]) -> xr.Dataset:
        """Return the task's variables with the swept names as leading dimensions."""
        return _merge(self, runs)

    @property
    def origin(self) -> dict[str, Any]:
        """Attributes that record what makes the result; swept parameters are its coordinates."""
        params, options = self._with({**options_of(self.task), **self.fixed})
        fixed = {
            name: value for name, value in options.items() if name not in self.vary
        }
        return origin(self.task, {"params": params, **fixed})


def planned(config: Mapping[str, Any]) -> SweepPlan:
    """The sweep of a configuration as :func:`squealpipe.ranges.sweep_config` makes it."""
    entries = {key: config[key] for key in ("task", "vary", "fixed")}
    if is_structure(config["task"]):
        of_points = config["task"].endswith(f":{OPERATING_MAP}")
        return (OperatingSweep if of_points else StructureSweep)(**entries)
    if is_system(config["task"]):
        return SystemSweep(**entries)
    return Sweep(**entries, params=parameters_of(config))


@checked
def run_sweep(
    sweep: SweepPlan, *, workers: Workers = None, kept: Chunks | None = None
) -> xr.Dataset:
    """Run a sweep.

    Args:
        sweep: what to run.
        workers: processes that share the runs, all cores by default. They are forked, so a script
            needs no main guard; where the system cannot fork, the runs stay here.
        kept: where finished runs are kept on disk; those that are there are not made again.

    Returns:
        The task's variables with the swept names as leading dimensions. Runs that are shorter
        than the longest along a dimension such as ``point`` are filled up with NaN, or the
        flag "absent", and ``<dimension>_count`` states their lengths.
    """
    return sweep.dataset(workers, kept)


def joined(
    config: Mapping[str, Any], parts: Sequence[xr.Dataset], along: str
) -> xr.Dataset:
    """Return a map or sweep from its parts, in order.

    Args:
        config: of the sweep, or of a map.
        along: what the parts differ in.
    """
    if is_structure(str(config.get("task", ""))):
        plan = planned(config)
        if isinstance(plan, OperatingSweep):
            # the share of points in a band is that of the whole map
            return plan.joined(parts)
    return join(parts, along)


def _merge(sweep: Sweep, runs: Callable[[], Iterator[Run]]) -> xr.Dataset:
    """One dataset of all runs, which are read twice: for the longest of each, then for values."""
    schema, base = sweep.schema, find(_schema(sweep.task))
    shape = tuple(len(sweep.vary[name]) for name in sweep.names)
    coords = {name: np.asarray(sweep.vary[name]) for name in sweep.names}
    shapes: dict[str, tuple[int, ...]] = {}
    types: dict[str, np.dtype] = {}
    for run in runs():
        for name, array in run.items():
            longest_run = zip(array.shape, shapes.get(name, array.shape), strict=True)
            shapes[name] = tuple(map(max, longest_run))
            types[name] = np.result_type(types.get(name, array.dtype), array.dtype)
    entries = {**base.coordinates, **base.variables}
    stacked = [
        name
        for name in [*entries, *(f"{dim}_count" for dim in ragged_dims(base))]
        if name in shapes and name not in sweep.names and name not in schema.coordinates
    ]
    data = {}
    for name in stacked:
        entry = entries.get(name)
        stored = entry.stored if entry is not None and is_ragged(entry) else types[name]
        kind = types[name] if stored.kind == "U" else stored
        data[name] = np.empty((len(sweep.points), *shapes[name]), kind)
    for number, arrays in enumerate(runs()):
        run = _in_order(arrays, coords, entries)
        for name, rows in data.items():
            filled = run[name].astype(rows.dtype)
            if name in entries and is_ragged(entries[name]):
                filled = fill_up(filled, shapes[name])
            if filled.shape != shapes[name]:
                raise ValueError(f"{name} has another size in other runs")
            rows[number] = filled
        for name, array in run.items():
            if name in schema.coordinates and name not in sweep.names:
                _refuse_other(name, array, coords.setdefault(name, array))
    whole = {
        name: array.reshape(shape + array.shape[1:]) for name, array in data.items()
    }
    return build(schema, whole, coords, sweep.origin)


def _schema(task: str) -> str:
    return "simulation" if task == "simulate" else task


def _in_order(
    run: Run, coords: Mapping[str, np.ndarray], entries: Mapping[str, Variable]
) -> Run:
    """A run with its words along each dimension in the order of the first one."""
    ordered = dict(run)
    for dim, first in coords.items():
        words = run.get(dim)
        if words is None or words.dtype.kind != "U" or np.array_equal(words, first):
            continue
        if sorted(words) != sorted(first):
            continue
        places = [words.tolist().index(word) for word in first]
        for name, array in ordered.items():
            dims = entries[name].dims if name in entries else ()
            if dim in dims:
                ordered[name] = np.take(array, places, axis=dims.index(dim))
    return ordered


def _refuse_other(name: str, array: np.ndarray, first: np.ndarray) -> None:
    """Raise if a coordinate that all runs share is another one in this run."""
    if not np.array_equal(array, first):
        remedy = (
            "; fix the option 'times', for instance 0:50:1001" if name == "time" else ""
        )
        raise ValueError(f"{name} differs from run to run{remedy}")


def outcome_lines(dataset: xr.Dataset, names: list[str]) -> list[str]:
    """Outcomes of the runs of a sweep counted, then the remedy of each that is not converged.

    Nothing of a task that always has an answer, and so no outcome.
    """
    if "outcome" not in dataset:
        return []
    words, codes = meanings(dataset.outcome), pd.Series(dataset.outcome.values.ravel())
    counts = codes[codes != ABSENT].value_counts().sort_index()
    counts = counts.sort_values(ascending=False, kind="stable")
    stated = [f"{words[code]} {count}" for code, count in counts.items()]
    unit = "runs" if dataset.outcome.ndim == len(names) else "points"
    remedies = {int(item): item.remedy for item in Outcome}
    return [
        f"outcome of {counts.sum()} {unit}: {', '.join(stated)}",
        *(
            f"{words[code]}: {remedies.get(code, 'a stop of the system')}"
            for code in counts.index
            if code != Outcome.converged
        ),
    ]
