"""Every task that the command line and sweeps can call by name."""

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.tasks.backbones.backbone import backbone
from squealpipe.tasks.backbones.orbit import periodic_orbit
from squealpipe.tasks.basins.disturbance import smallest_disturbance
from squealpipe.tasks.dynamics.hammering import hammering_map
from squealpipe.tasks.dynamics.runs import simulate, validity_map
from squealpipe.tasks.linear.critical import critical_friction_map
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map


@dataclass(frozen=True)
class Task:
    """A task by name.

    Attributes:
        maps_angles: it takes arrays of angles and maps them; else it takes one pair.
    """

    run: Callable[..., xr.Dataset]
    schema: str
    maps_angles: bool

    @property
    def options(self) -> dict[str, bool]:
        """Keyword → whether it must be given; how many processes to use is not among them."""
        given = inspect.signature(self.run).parameters.values()
        return {
            item.name: item.default is item.empty
            for item in given
            if item.kind is item.KEYWORD_ONLY and item.name != "workers"
        }

    @property
    def defaults(self) -> dict[str, Any]:
        """Keyword → default, of those that need not be given."""
        given = inspect.signature(self.run).parameters
        return {name: given[name].default for name, needed in self.options.items() if not needed}

    @property
    def uses_workers(self) -> bool:
        """Whether it can use several processes by itself."""
        return "workers" in inspect.signature(self.run).parameters


TASKS: dict[str, Task] = {
    "simulate": Task(simulate, "simulation", maps_angles=False),
    "validity_map": Task(validity_map, "validity_map", maps_angles=True),
    "hammering_map": Task(hammering_map, "hammering_map", maps_angles=True),
    "quasi_static_map": Task(quasi_static_map, "quasi_static_map", maps_angles=True),
    "stability_map": Task(stability_map, "stability_map", maps_angles=True),
    "critical_friction_map": Task(critical_friction_map, "critical_friction_map", maps_angles=True),
    "natural_frequencies": Task(natural_frequencies, "natural_frequencies", maps_angles=True),
    "periodic_orbit": Task(periodic_orbit, "periodic_orbit", maps_angles=False),
    "backbone": Task(backbone, "backbone", maps_angles=False),
    "smallest_disturbance": Task(smallest_disturbance, "smallest_disturbance", maps_angles=False),
}


def run_task(name: str, params: Parameters, alpha1: Any, alpha2: Any, **options: Any) -> xr.Dataset:
    """Run a task by name; single angles become arrays of one where the task maps angles."""
    task = TASKS[name]
    if task.maps_angles:
        alpha1, alpha2 = np.atleast_1d(alpha1), np.atleast_1d(alpha2)
    return task.run(params, alpha1, alpha2, **options)
