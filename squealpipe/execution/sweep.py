"""Any task over ranges of parameters, angles and options, as one labelled dataset."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import get_all_start_methods, get_context
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.config.ranges import NUMBERS, PHYSICAL, longest
from squealpipe.execution.catalogue import TASKS, run_task
from squealpipe.execution.packing import pack, unpack
from squealpipe.execution.row_blocks import scattered_rows
from squealpipe.execution.system_sweep import SystemSweep, is_system
from squealpipe.methods.processes import available_cores, leave_interrupts_to_the_parent
from squealpipe.parameters import Parameters, parameters_of
from squealpipe.schema import DatasetSchema, Variable, build, find
from squealpipe.schema.origin import origin
from squealpipe.schema.sweep import OPTIONS, fill_up, is_ragged, ragged_dims, sweep_name
from squealpipe.store.chunks import Arrays, Checkpoint, run_chunks
from squealpipe.text import suggestion
from squealpipe.validation import Line, checked

CHUNKS = 256
"""A sweep is kept in at most so many part files: enough to resume finely, cheap to write."""


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
        self._check_varied()
        self._check_fixed()
        if not self.names:
            raise ValueError(
                f"nothing to sweep: {self.task} maps both angles by itself; vary a parameter too"
            )

    def _check_varied(self) -> None:
        allowed = [*NUMBERS, "alpha1", "alpha2"]
        allowed += [name for name in TASKS[self.task].options if name in OPTIONS]
        for name, values in self.vary.items():
            if name not in allowed:
                raise ValueError(
                    f"{name!r} cannot be varied for {self.task}; {suggestion(name, allowed)}"
                )
            if not len(values) or len(set(values)) != len(values):
                raise ValueError(f"{name} needs one or more values, each once, not {values!r}")
            for value in values if name in self._physical else ():
                self.params.with_(**{name: value})

    @property
    def _physical(self) -> list[str]:
        """Names that mean a parameter, not an option of the task."""
        return [name for name in PHYSICAL if name not in TASKS[self.task].options]

    def _check_fixed(self) -> None:
        options = TASKS[self.task].options
        for name in set(self.fixed) - {"alpha1", "alpha2", *options, *self._physical}:
            raise ValueError(
                f"{self.task} has no option {name!r}; it has {', '.join(options) or 'none'}"
            )
        for name in set(self.fixed) & set(self._physical):
            self.params.with_(**{name: self.fixed[name]})
        needed = {"alpha1", "alpha2", *(name for name in options if options[name])}
        for name in sorted(needed | (set(self.vary) & set(self.fixed))):
            if (name in self.vary) == (name in self.fixed):
                raise ValueError(f"{self.task} needs {name} once, fixed or varied")

    @property
    def names(self) -> list[str]:
        """Swept names in the order given; angles that the task itself maps are not among them."""
        inner = ("alpha1", "alpha2") if TASKS[self.task].maps_angles else ()
        return [name for name in self.vary if name not in inner]

    @property
    def points(self) -> list[tuple[float, ...]]:
        """Values of the swept names at every point, last name fastest."""
        return list(itertools.product(*(self.vary[name] for name in self.names)))

    @property
    def schema(self) -> DatasetSchema:
        """Schema of the result."""
        return find(sweep_name(TASKS[self.task].schema, self.names))

    def run(self, point: Sequence[float], workers: int | None = None) -> xr.Dataset:
        """The task at one point, in so many processes where it can use several."""
        given = {**self.fixed, **self.vary, **dict(zip(self.names, point, strict=True))}
        params = self.params.with_(
            **{name: given.pop(name) for name in self._physical if name in given}
        )
        if TASKS[self.task].uses_workers:
            given["workers"] = workers
        return run_task(self.task, params, given.pop("alpha1"), given.pop("alpha2"), **given)

    @property
    def origin(self) -> dict[str, Any]:
        """Attributes that tell what makes the result; swept parameters are its coordinates."""
        task = TASKS[self.task]
        given = {**task.defaults, **self.fixed}
        physical = {name: given.pop(name) for name in self._physical if name in given}
        fixed = {name: value for name, value in given.items() if name not in self.vary}
        return origin(self.task, {"params": self.params.with_(**physical), **fixed})

    def part(self, item: str) -> Sweep:
        """One part of a scattered sweep: some of the values of the longest name.

        Args:
            item: "i-of-n", Snakemake's name of a part.

        Raises:
            ValueError: another form, or there are more parts than values.
        """
        cut = longest(self.vary)
        values = self.vary[cut]
        return replace(self, vary={**self.vary, cut: values[scattered_rows(len(values), item)]})


def planned(config: Mapping[str, Any]) -> Sweep | SystemSweep:
    """The sweep of a configuration as :func:`squealpipe.config.ranges.sweep_config` makes it.

    Raises:
        ValueError: as :class:`Sweep` or :class:`SystemSweep`.
    """
    if is_system(config["task"]):
        return SystemSweep(task=config["task"], vary=config["vary"], fixed=config["fixed"])
    return Sweep(
        task=config["task"],
        params=parameters_of(config),
        vary=config["vary"],
        fixed=config["fixed"],
    )


@dataclass(frozen=True)
class _Chunk:
    """Consecutive points of a sweep; picklable, so that a worker process can compute it."""

    sweep: Sweep
    start: int
    stop: int
    workers: int | None


def _compute(chunk: _Chunk) -> Arrays:
    """Arrays of all points of a chunk, packed."""
    points = chunk.sweep.points[chunk.start : chunk.stop]
    datasets = [chunk.sweep.run(point, chunk.workers) for point in points]
    return pack(
        [{str(name): item.values for name, item in one.variables.items()} for one in datasets]
    )


@contextmanager
def executor(workers: int | None = None) -> Iterator[Executor | None]:
    """Processes to share a sweep; None where one is asked for or the system cannot fork.

    They are forked, so a script that sweeps needs no main guard.

    Args:
        workers: number of processes; all cores by default.

    Raises:
        ValueError: fewer than one worker.
    """
    number = available_cores() if workers is None else workers
    if number < 1:
        raise ValueError(f"workers = {number}: must be 1 or greater")
    if number == 1 or "fork" not in get_all_start_methods():
        yield None
        return
    pool = ProcessPoolExecutor(
        number, mp_context=get_context("fork"), initializer=leave_interrupts_to_the_parent
    )
    try:
        yield pool
    except BaseException:
        # What waits is dropped and what runs is ended: an interrupt must not wait for the rest.
        workers_now = list((pool._processes or {}).values())  # noqa: SLF001 (public from 3.14)
        pool.shutdown(wait=False, cancel_futures=True)
        for process in workers_now:
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


@checked
def run_sweep(
    sweep: Sweep | SystemSweep,
    *,
    executor: Executor | None = None,
    checkpoint: Checkpoint | None = None,
) -> xr.Dataset:
    """Run a sweep.

    Args:
        sweep: what to run.
        executor: processes that share the work; None computes here.
        checkpoint: where finished chunks are kept until all are done.

    Returns:
        The task's variables with the swept names as leading dimensions. Runs that are shorter
        than the longest along a dimension such as ``point`` are filled up with NaN, or the
        flag "absent", and ``<dimension>_count`` tells their lengths.
    """
    workers = None if executor is None else 1
    if isinstance(sweep, SystemSweep):
        return sweep.run(None if executor else 1)  # an ensemble shares its runs by itself
    count = len(sweep.points)
    size = -(-count // CHUNKS)
    chunks = [_Chunk(sweep, at, min(at + size, count), workers) for at in range(0, count, size)]
    parts = run_chunks(
        _compute,
        chunks,
        checkpoint=checkpoint,
        executor=executor,
        sizes=[chunk.stop - chunk.start for chunk in chunks],
        label=f"sweep of {sweep.task}",
        unit="runs",
    )
    return _merge(sweep, [run for part in parts for run in unpack(part)])


def _merge(sweep: Sweep, runs: Sequence[Arrays]) -> xr.Dataset:
    schema, base = sweep.schema, find(TASKS[sweep.task].schema)
    shape = tuple(len(sweep.vary[name]) for name in sweep.names)
    data, coords = {}, {name: np.asarray(sweep.vary[name]) for name in sweep.names}
    for name, entry in {**base.coordinates, **base.variables}.items():
        if name in sweep.names or name not in runs[0]:
            continue
        if name in schema.coordinates:
            coords[name] = _common(name, [run[name] for run in runs])
            continue
        stacked = _stack([run[name] for run in runs], entry)
        data[name] = stacked.reshape(shape + stacked.shape[1:])
    for dim in ragged_dims(base):
        data[f"{dim}_count"] = np.reshape([_length(run, dim, base) for run in runs], shape)
    return build(schema, data, coords, sweep.origin)


def _common(name: str, arrays: Sequence[np.ndarray]) -> np.ndarray:
    """A coordinate that all runs share."""
    if any(not np.array_equal(array, arrays[0]) for array in arrays):
        remedy = "; fix the option 'times', for instance 0:50:1001" if name == "time" else ""
        raise ValueError(f"{name} differs from run to run{remedy}")
    return arrays[0]


def _stack(arrays: Sequence[np.ndarray], entry: Variable) -> np.ndarray:
    """All runs in one array, shorter ones filled up."""
    if not is_ragged(entry):
        return np.stack(arrays)
    longest_run = tuple(np.max([array.shape for array in arrays], axis=0))
    return np.stack([fill_up(array.astype(entry.dtype), longest_run) for array in arrays])


def _length(run: Arrays, dim: str, base: DatasetSchema) -> int:
    for name, entry in {**base.variables, **base.coordinates}.items():
        if name in run and dim in entry.dims:
            return int(run[name].shape[entry.dims.index(dim)])
    return 0
