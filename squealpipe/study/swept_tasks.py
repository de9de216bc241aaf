"""Every task that the command line and sweeps can call by name."""

import inspect
from collections.abc import Callable
from typing import Any

import xarray as xr

from squealpipe.brake.assess.assess import assess
from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.brake.basins.disturbance import smallest_disturbance
from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.linear.critical import critical_friction_map
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)

TASKS_OF_ONE_PAIR = (simulate, periodic_orbit, backbone, smallest_disturbance, assess)
MAPS = (
    *(validity_map, hammering_map, quasi_static_map, stability_map),
    *(critical_friction_map, natural_frequencies),
)
"""Tasks that take arrays of angles."""
TASKS: dict[str, Callable[..., xr.Dataset]] = {
    run.__name__: run for run in (*TASKS_OF_ONE_PAIR, *MAPS)
}


def options_of(task: str) -> dict[str, Any]:
    """Return option → default, ``Parameter.empty`` where there is none, without ``workers``."""
    return {
        name: item.default
        for name, item in inspect.signature(TASKS[task]).parameters.items()
        if item.kind is item.KEYWORD_ONLY and name != "workers"
    }
