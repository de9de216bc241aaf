"""Every task that the command line and sweeps can call by name."""

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import xarray as xr

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
    maps_angles: bool

    @property
    def schema(self) -> str:
        """Name of the schema of its dataset."""
        return "simulation" if self.run is simulate else self.run.__name__

    @cached_property
    def parameters(self) -> Mapping[str, inspect.Parameter]:
        """What it takes."""
        return inspect.signature(self.run).parameters

    @property
    def defaults(self) -> dict[str, Any]:
        """Option → default, :data:`NEEDED` if there is none; but not how many processes it uses."""
        return {
            name: item.default
            for name, item in self.parameters.items()
            if item.kind is item.KEYWORD_ONLY and name != "workers"
        }


NEEDED = inspect.Parameter.empty
ONE_PAIR = (simulate, periodic_orbit, backbone, smallest_disturbance)
MAPS = (
    *(validity_map, hammering_map, quasi_static_map, stability_map),
    *(critical_friction_map, natural_frequencies),
)
TASKS = {run.__name__: Task(run, maps_angles=run in MAPS) for run in (*ONE_PAIR, *MAPS)}
