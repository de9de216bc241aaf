"""A sweep of a system of the user's own: ``FILE.py:NAME``, over its starts and parameters."""

import inspect
import math
import runpy
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from squealpipe.laws.one_file import without_neighbours
from squealpipe.ranges import longest
from squealpipe.study.chunks import Chunks, Run
from squealpipe.study.sweep_plan import SweepPlan
from squealpipe.systems import basin, runs
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.processes import available_cores
from squealpipe.systems.progress import part_of_work
from squealpipe.systems.system import System
from squealpipe.systems.taylor.simd import LANES

FIRST_BLOCK, LARGEST_BLOCK = LANES, 8192
"""Runs of the first block, and of the largest."""


def is_system(task: str) -> bool:
    """Return whether a task is a system in a file."""
    return ":" in task


def find_system(place: str) -> System:
    """The system of ``FILE.py:NAME``."""
    file, _, name = place.partition(":")
    if not Path(file).is_file():
        raise ValueError(
            f"no file {file!r}; a system is named like impact.py:impact_oscillator"
        )
    defined = _run(file)
    system = defined.get(name)
    if not isinstance(system, System):
        known = [key for key, value in defined.items() if isinstance(value, System)]
        raise ValueError(  # noqa: TRY004
            f"{file} defines no system {name!r}; {suggestion(name, known)}"
        )
    return system


def _run(file: str) -> dict[str, Any]:
    """Execute a file; whatever it raises becomes an error that says where."""
    try:
        with without_neighbours():
            return runpy.run_path(file)
    except ModuleNotFoundError as error:
        raise ValueError(
            f"{file} imports what is not there ({error}); a system is one file, so put its code "
            "in there"
        ) from error
    except (Exception, SystemExit) as error:
        if isinstance(error, SyntaxError):
            lines = [error.lineno]
        else:
            frames = traceback.extract_tb(error.__traceback__)
            lines = [frame.lineno for frame in frames if frame.filename == file]
        where = f"{file}, line {lines[-1]}," if lines else file
        raise ValueError(
            f"{where} failed with {type(error).__name__}: {error}; correct it, then run "
            "the same command again"
        ) from error


@dataclass(frozen=True, kw_only=True)
class SystemSweep(SweepPlan):
    """A system's ensemble, or basin, over ranges.

    Attributes:
        task: ``FILE.py:NAME``.
        vary: name → values, of parameters and of starts (``x0``).
        fixed: further ones, ``t_end``, and ``run``: ensemble (by default) or basin, with its
            options.
    """

    ways: ClassVar[Mapping[str, Callable[..., xr.Dataset]]] = {
        "ensemble": runs.ensemble,
        "basin": basin.basin,
    }

    system: System = field(init=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "system", find_system(self.task))
        way = self.fixed.get("run", "ensemble")
        if way not in SystemSweep.ways:
            raise ValueError(f"run = {way!r}: {suggestion(way, SystemSweep.ways)}")
        known = [*self.system.start_names.values(), *self.system.parameters]
        options = [
            name
            for name in inspect.signature(SystemSweep.ways[way]).parameters
            if name not in ("system", "start", "parameters", "workers")
        ]
        for name in (*self.vary, *(set(self.fixed) - {"run", *options})):
            if name not in known:
                near = suggestion(name, [*known, *options])
                raise ValueError(f"{self.system.name}: {name!r} is unknown; {near}")
        if "t_end" not in self.fixed:
            raise ValueError(f"{self.system.name} needs t_end, fixed")

    def dataset(
        self, workers: int | None = None, kept: Chunks | None = None
    ) -> xr.Dataset:
        """Return the ensemble or basin, its dimensions starts first; it shares runs by itself."""
        along = self._cut()
        if kept is None or along is None:
            return self._block({}, workers)
        rows = len(self.vary[along])
        runs_of_row = math.prod(map(len, self.vary.values())) // rows
        done, size, part = kept.finished(), FIRST_BLOCK, None
        while done < rows:
            count = min(max(1, size // runs_of_row), rows - done)
            used = workers or available_cores()
            used = max(1, min(used, count * runs_of_row // LANES))
            started = time.monotonic()
            with part_of_work(done / rows, count / rows):
                chosen = slice(done, done + count)
                part = self._block({along: self.vary[along][chosen]}, used)
            kept.save(done, _rows(part, along))
            done += count
            # a block of runs should take about 5 s, so that a stopped sweep loses little
            quick = time.monotonic() - started < 5.0
            size = (
                min(2 * size, LARGEST_BLOCK) if quick else max(size // 2, FIRST_BLOCK)
            )
        if part is None:  # all were there, but for what names and describes them
            part = self._block({along: self.vary[along][:1]}, workers)
        return self._joined(part, along, kept)

    def finished(self, kept: Chunks) -> int:
        """Number of runs that are there."""
        along = self._cut()
        if along is None:
            return 0
        runs = math.prod(map(len, self.vary.values()))
        return kept.finished() * runs // len(self.vary[along])

    def _cut(self) -> str | None:
        """The name along which blocks of runs do not differ from the whole; None: there is none."""
        names = list(self.vary)
        if self.fixed.get("run") == "basin":
            # which looks at as many periods of the forcing as fit at all parameters
            names = [name for name in names if name in self.system.start_names.values()]
        return longest({name: self.vary[name] for name in names}) if names else None

    def _joined(self, part: xr.Dataset, along: str, kept: Chunks) -> xr.Dataset:
        """The whole of a part and of what is on disk."""
        rows = list(kept.runs())
        whole = {
            name: (
                variable.dims,
                np.stack([row[str(name)] for row in rows], variable.dims.index(along))
                if along in variable.dims
                else variable.values,
                variable.attrs,
            )
            for name, variable in part.variables.items()
        }
        joined = xr.Dataset(whole, attrs=part.attrs).set_coords([*part.coords])
        if "attractor" in joined:
            return basin.renumbered(self.system, joined)
        return joined

    def _block(
        self, some: Mapping[str, Sequence[float]], workers: int | None
    ) -> xr.Dataset:
        """The runs with some of the values."""
        options = {**self.fixed, **self.vary, **some}
        way = SystemSweep.ways[options.pop("run", "ensemble")]
        names = self.system.start_names.items()
        start = {state: options.pop(name) for state, name in names if name in options}
        return way(
            self.system, options.pop("t_end"), start=start, workers=workers, **options
        )


def _rows(part: xr.Dataset, along: str) -> list[Run]:
    """Yield the values of one part of the sweep, one after another for each name."""
    values = {
        str(name): np.moveaxis(variable.values, variable.dims.index(along), 0)
        for name, variable in part.variables.items()
        if along in variable.dims
    }
    return [
        {name: np.asarray(array[row]) for name, array in values.items()}
        for row in range(part.sizes[along])
    ]
