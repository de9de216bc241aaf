"""A sweep of a system of the user's own: ``FILE.py:NAME``, over its starts and parameters."""

from __future__ import annotations

import inspect
import runpy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

import xarray as xr

from squealpipe.execution.scatter import scattered_values
from squealpipe.systems import basin, runs
from squealpipe.systems.system import System
from squealpipe.text import suggestion

WAYS = {"ensemble": runs.ensemble, "basin": basin.basin}


def is_system(task: str) -> bool:
    """Whether a task is a system in a file."""
    return ":" in task


def find_system(place: str) -> System:
    """The system of ``FILE.py:NAME``."""
    file, _, name = place.partition(":")
    if not Path(file).is_file():
        raise ValueError(
            f"no file {file!r}; a system is named like impact.py:impact_oscillator"
        )
    defined = runpy.run_path(file)
    found = defined.get(name)
    if not isinstance(found, System):
        known = [key for key, value in defined.items() if isinstance(value, System)]
        raise ValueError(  # noqa: TRY004
            f"{file} defines no system {name!r}; {suggestion(name, known)}"
        )
    return found


@dataclass(frozen=True, kw_only=True)
class SystemSweep:
    """A system's ensemble, or basin, over ranges.

    Attributes:
        task: ``FILE.py:NAME``.
        vary: name → values, of parameters and of starts (``x0``).
        fixed: further ones, ``t_end``, and ``run``: ensemble (by default) or basin, with its
            options.
    """

    task: str
    vary: Mapping[str, Sequence[float]]
    fixed: Mapping[str, Any]
    system: System = field(init=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "system", find_system(self.task))
        way = self.fixed.get("run", "ensemble")
        if way not in WAYS:
            raise ValueError(f"run = {way!r}: {suggestion(way, WAYS)}")
        known = [*self.system.start_names.values(), *self.system.parameters]
        options = [
            name
            for name in inspect.signature(WAYS[way]).parameters
            if name not in ("system", "start", "parameters", "workers")
        ]
        for name in (*self.vary, *(set(self.fixed) - {"run", *options})):
            if name not in known:
                near = suggestion(name, [*known, *options])
                raise ValueError(f"{self.system.name}: {name!r} is unknown; {near}")
        if "t_end" not in self.fixed:
            raise ValueError(f"{self.system.name} needs t_end, fixed")

    @property
    def names(self) -> list[str]:
        """Swept names in the order given."""
        return list(self.vary)

    def scattered(self, item: str) -> Self:
        """One part of a scattered sweep, ``i-of-n`` along its longest name."""
        return replace(self, vary=scattered_values(self.vary, item))

    def run(self, workers: int | None = None) -> xr.Dataset:
        """The dataset, its dimensions starts first."""
        given = {**self.fixed, **self.vary}
        way = WAYS[given.pop("run", "ensemble")]
        names = self.system.start_names.items()
        start = {state: given.pop(name) for state, name in names if name in given}
        return way(
            self.system, given.pop("t_end"), start=start, workers=workers, **given
        )
