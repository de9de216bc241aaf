"""What a request will cost, stated before it begins; large ones need --yes.

The rates were measured on one core of an ordinary server and are right within a factor of a few,
which is enough to tell minutes from days.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from squealpipe.parameters import HORIZON, Parameters
from squealpipe.progress import duration

MOST_SECONDS = 1800.0
MOST_BYTES = 2e9
WORTH_A_WORD = 5.0

SECONDS = {
    "simulate": 1.5e-4,
    "validity_map": 1e-6,
    "hammering_map": 8e-6,
    "quasi_static_map": 1e-6,
    "stability_map": 1e-6,
    "critical_friction_map": 2e-6,
    "natural_frequencies": 1e-6,
    "periodic_orbit": 0.01,
    "backbone": 0.05,
    "smallest_disturbance": 2.0,
}
"""Per run, or per cell of a map, on one core; the first three also per unit of time √(m/k1)."""

BYTES = {"simulate": 200, "natural_frequencies": 500, "periodic_orbit": 2000, "backbone": 40_000}
"""Per run; ``simulate`` per instant, ``natural_frequencies`` per cell, other maps ``MAP_BYTES``."""

TIMED = ("simulate", "validity_map", "hammering_map")
MAP_BYTES = 300


@dataclass(frozen=True)
class Cost:
    """An estimate: ``seconds`` with all cores, ``memory`` in bytes."""

    seconds: float
    memory: float

    def __str__(self) -> str:
        return f"about {duration(self.seconds)} and {_size(self.memory)} of memory"

    @property
    def told(self) -> str:
        """The estimate where it is worth a word."""
        return f", {self}" if self.seconds > WORTH_A_WORD else ""

    def check(self, *, yes: bool) -> None:
        """Refuse what takes long or much, unless the user has said yes.

        Raises:
            ValueError: with the estimate and the remedy.
        """
        if (self.seconds > MOST_SECONDS or self.memory > MOST_BYTES) and not yes:
            raise ValueError(f"this takes {self}; ask for less, or add --yes to do it")


def estimate(
    task: str,
    params: Parameters,
    options: Mapping[str, Any],
    *,
    runs: int = 1,
    samples: int | None = None,
    workers: int | None = None,
) -> Cost:
    """The cost of a task.

    Args:
        task: its name in the catalogue.
        params: physical parameters.
        options: its options; of one that is varied the largest value.
        runs: runs, or cells of a map.
        samples: instants of a run of ``simulate``.
        workers: processes; all cores by default.
    """
    seconds, memory = SECONDS[task], float(BYTES.get(task, MAP_BYTES))
    if task in TIMED:
        horizon = float(options.get("t_end") or HORIZON * params.time_unit) / params.time_unit
        seconds *= horizon
        if task == "simulate":
            from squealpipe.tasks.sampling import COARSE, FINE, PLENTY

            radians = params.fastest * params.time_unit * horizon
            usual = max(min(FINE * radians, PLENTY), COARSE * radians)
            count = usual if samples is None else samples
            memory *= count
            seconds += 5e-7 * count
    if options.get("method") == "hbm":
        seconds = 8e-4 * float(options.get("n_harmonics", 16)) ** 2
    cores = 1 if runs == 1 else workers or os.cpu_count() or 1
    return Cost(seconds=seconds * runs / cores, memory=memory * runs)


def of_sweep(config: Mapping[str, Any], params: Parameters, workers: int | None) -> Cost:
    """The cost of a sweep, from its configuration."""
    options = {**config["fixed"], **{name: max(values) for name, values in config["vary"].items()}}
    runs = prod(len(values) for values in config["vary"].values())
    for name in ("alpha1", "alpha2"):
        angles = config["fixed"].get(name)
        runs *= len(angles) if isinstance(angles, Sequence) else 1
    times = options.get("times")
    samples = len(times) if isinstance(times, Sequence) else None
    return estimate(config["task"], params, options, runs=runs, samples=samples, workers=workers)


def _size(count: float) -> str:
    for unit in ("B", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:,.0f} TB"
