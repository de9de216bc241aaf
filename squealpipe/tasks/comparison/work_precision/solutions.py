"""Error against cost: how one solution is timed, and the table that holds all of them."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable
from typing import NamedTuple, TypeVar

import numpy as np
import xarray as xr

from squealpipe.schema import Outcome, build
from squealpipe.schema.comparison import WORK_PRECISION, Role

_Result = TypeVar("_Result")

_SHORT = 2e-3
"""A run shorter than this, s, is called several times between two readings of the clock."""
_LONG = 0.1
"""A run longer than this, s, is called twice at most: it scatters little, and all cores wait."""


class Solution(NamedTuple):
    """One method at one setting on one scene; the fields are those of the dataset."""

    task: str
    scene: str
    method: str
    setting: str
    role: Role
    error: float
    wall_time: float
    evaluations: float
    reference_error: float
    outcome: Outcome = Outcome.converged


def timed(run: Callable[[], _Result], repeats: int) -> tuple[_Result, float]:
    """The result of a run and the median wall time of ``repeats`` runs, s.

    The median drops what the first run compiles or allocates, from three repeats on; of two runs,
    as many as long ones get, the shorter counts.
    """
    result, first = _clocked(run, 1)
    calls = 1 if first > _SHORT else 5
    others = (min(repeats, 2) if first > _LONG else repeats) - 1
    return result, statistics.median_low([first, *(_clocked(run, calls)[1] for _ in range(others))])


def _clocked(run: Callable[[], _Result], calls: int) -> tuple[_Result, float]:
    started = time.perf_counter()
    result = run()
    for _ in range(calls - 1):
        run()
    return result, (time.perf_counter() - started) / calls


def work_precision(solutions: Iterable[Solution]) -> xr.Dataset:
    """The dataset ``work_precision`` of some solutions."""
    rows = list(solutions)
    columns = {name: [getattr(row, name) for row in rows] for name in Solution._fields}
    return build(WORK_PRECISION, columns, {"run": np.arange(len(rows))})
