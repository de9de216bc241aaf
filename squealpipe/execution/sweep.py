"""Any task over ranges of parameters, angles and options, as one labelled dataset."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import active_children, get_all_start_methods, get_context
from typing import Any, Self

import numpy as np
import pandas as pd
import xarray as xr

from squealpipe.config.ranges import ANGLES, NUMBERS, PHYSICAL
from squealpipe.execution.catalogue import MAPS, NEEDED, TASKS, options_of
from squealpipe.execution.scatter import scattered_values
from squealpipe.execution.system_sweep import SystemSweep, is_system
from squealpipe.methods.processes import available_cores, leave_interrupts_to_the_parent
from squealpipe.methods.progress import alone
from squealpipe.parameters import Parameters, parameters_of
from squealpipe.schema import ABSENT, DatasetSchema, Outcome, build, find, meanings
from squealpipe.schema.origin import origin
from squealpipe.schema.sweep import OPTIONS, fill_up, is_ragged, ragged_dims, sweep_name
from squealpipe.text import suggestion
from squealpipe.validation import Line, Workers, checked


@checked
def _gate(
    task: str, params: Parameters, vary: Mapping[str, Line], fixed: Mapping[str, Any]
) -> None:
    """Types of the fields of a sweep."""


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """What to run: a task, what stays fixed, and what is varied over which values.

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

    task: str
    params: Parameters
    vary: Mapping[str, Sequence[float]]
    fixed: Mapping[str, Any]

    def __post_init__(self) -> None:
        _gate(self.task, self.params, self.vary, self.fixed)
        if self.task not in TASKS:
            raise ValueError(f"no task {self.task!r}; {suggestion(self.task, TASKS)}")
        options = options_of(self.task)
        varied = [*NUMBERS, *ANGLES, *(name for name in options if name in OPTIONS)]
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
        for name in set(self.fixed) - {*ANGLES, *options, *PHYSICAL}:
            known = ", ".join(options) or "none"
            raise ValueError(f"{self.task} has no option {name!r}; it has {known}")
        self._with(self.fixed)
        needed = {*ANGLES, *(name for name in options if options[name] is NEEDED)}
        for name in sorted(needed | (set(self.vary) & set(self.fixed))):
            if (name in self.vary) == (name in self.fixed):
                raise ValueError(f"{self.task} needs {name} once, fixed or varied")
        if not self.names:
            raise ValueError(
                f"nothing to sweep: {self.task} maps both angles by itself; vary a parameter too"
            )

    def _with(self, given: Mapping[str, Any]) -> tuple[Parameters, dict[str, Any]]:
        """The parameters with what is given of them, and the rest: angles and options."""
        options = options_of(self.task)
        physical = {name for name in given if name in PHYSICAL and name not in options}
        params = self.params.with_(**{name: given[name] for name in physical})
        return params, {name: given[name] for name in given if name not in physical}

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
        params, given = self._with({**self.fixed, **self.vary, **point_by_name})
        angles = [given.pop(name) for name in ANGLES]
        task = TASKS[self.task]
        if "workers" in inspect.signature(task).parameters:
            given["workers"] = workers
        if task in MAPS:
            angles = [np.atleast_1d(angle) for angle in angles]
        return task(params, *angles, **given)

    @property
    def origin(self) -> dict[str, Any]:
        """Attributes that record what makes the result; swept parameters are its coordinates."""
        params, given = self._with({**options_of(self.task), **self.fixed})
        fixed = {name: value for name, value in given.items() if name not in self.vary}
        return origin(self.task, {"params": params, **fixed})

    def scattered(self, item: str) -> Self:
        """One part of a scattered sweep: some of the values of the longest name."""
        return replace(self, vary=scattered_values(self.vary, item))


def planned(config: Mapping[str, Any]) -> Sweep | SystemSweep:
    """The sweep of a configuration as :func:`squealpipe.config.ranges.sweep_config` makes it."""
    given = {key: config[key] for key in ("task", "vary", "fixed")}
    if is_system(config["task"]):
        return SystemSweep(**given)
    return Sweep(**given, params=parameters_of(config))


@checked
def run_sweep(sweep: Sweep | SystemSweep, *, workers: Workers = None) -> xr.Dataset:
    """Run a sweep.

    Args:
        sweep: what to run.
        workers: processes that share the runs, all cores by default. They are forked, so a script
            needs no main guard; where the system cannot fork, the runs stay here.

    Returns:
        The task's variables with the swept names as leading dimensions. Runs that are shorter
        than the longest along a dimension such as ``point`` are filled up with NaN, or the
        flag "absent", and ``<dimension>_count`` states their lengths.
    """
    if isinstance(sweep, SystemSweep):
        return sweep.run(workers)  # an ensemble shares its runs by itself
    with alone() as show:
        runs = []
        for run in _runs(sweep, workers):
            runs.append(run)
            show(len(runs) / len(sweep.points))
    return _merge(sweep, runs)


def _runs(sweep: Sweep, workers: int | None) -> Iterator[xr.Dataset]:
    points = sweep.points
    number = min(workers or available_cores(), len(points))
    if number == 1 or "fork" not in get_all_start_methods():
        yield from map(partial(sweep.run, workers=workers), points)
        return
    others = set(active_children())
    with ProcessPoolExecutor(
        number, get_context("fork"), leave_interrupts_to_the_parent
    ) as pool:
        try:
            # not by its map, which cancels runs to come: the pool's thread trips over those
            runs = [pool.submit(sweep.run, point, workers=1) for point in points]
            for run in runs:
                yield run.result()
        except BaseException:
            for process in set(active_children()) - others:
                process.terminate()  # the pool is broken then and waits for no other run
            raise


def _merge(sweep: Sweep, runs: Sequence[xr.Dataset]) -> xr.Dataset:
    schema, base = sweep.schema, find(_schema(sweep.task))
    runs = [_in_order(run, runs[0]) for run in runs]
    shape = tuple(len(sweep.vary[name]) for name in sweep.names)
    data, coords = {}, {name: np.asarray(sweep.vary[name]) for name in sweep.names}
    for name, entry in {**base.coordinates, **base.variables}.items():
        if name in sweep.names or name not in runs[0]:
            continue
        if name in schema.coordinates:
            coords[name] = _common(name, [run[name].values for run in runs])
            continue
        arrays = [run[name].values for run in runs]
        if is_ragged(entry):  # shorter ones are filled up
            longest_run = tuple(np.max([array.shape for array in arrays], axis=0))
            arrays = [
                fill_up(array.astype(entry.dtype), longest_run) for array in arrays
            ]
        stacked = np.stack(arrays)
        data[name] = stacked.reshape(shape + stacked.shape[1:])
    for dim in ragged_dims(base):
        data[f"{dim}_count"] = np.reshape(
            [run.sizes.get(dim, 0) for run in runs], shape
        )
    return build(schema, data, coords, sweep.origin)


def _schema(task: str) -> str:
    return "simulation" if task == "simulate" else task


def _in_order(run: xr.Dataset, first: xr.Dataset) -> xr.Dataset:
    """A run with its words along each dimension in the order of the first one."""
    for name, words in first.coords.items():
        other = run[name].values
        ours = words.values
        if words.dtype.kind not in "UO" or np.array_equal(ours, other):
            continue
        if sorted(ours) == sorted(other):
            run = run.sel({str(name): ours})
    return run


def _common(name: str, arrays: Sequence[np.ndarray]) -> np.ndarray:
    """A coordinate that all runs share."""
    if any(not np.array_equal(array, arrays[0]) for array in arrays):
        remedy = (
            "; fix the option 'times', for instance 0:50:1001" if name == "time" else ""
        )
        raise ValueError(f"{name} differs from run to run{remedy}")
    return arrays[0]


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
