"""Reproducible computation on friction-induced vibration with contact loss.

Everything public is loaded on first use, so importing one part never costs, nor makes a
workflow depend on, the others.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from squealpipe.parameters import SCENES, Parameters, Scene
    from squealpipe.store.netcdf import load, save
    from squealpipe.tasks.backbones import backbone
    from squealpipe.tasks.dynamics import simulate, validity_map
    from squealpipe.tasks.hammering import hammering_map
    from squealpipe.tasks.inference import infer_parameters
    from squealpipe.tasks.linear import natural_frequencies, quasi_static_map, stability_map
    from squealpipe.tasks.model_choice import choose_model
    from squealpipe.tasks.orbits import periodic_orbit
    from squealpipe.tasks.refinement import refine_validity_map
    from squealpipe.tasks.summary import summarize
    from squealpipe.tasks.sweep import Sweep, run_sweep

_HOME = {
    "SCENES": "squealpipe.parameters",
    "Parameters": "squealpipe.parameters",
    "Scene": "squealpipe.parameters",
    "Sweep": "squealpipe.tasks.sweep",
    "backbone": "squealpipe.tasks.backbones",
    "choose_model": "squealpipe.tasks.model_choice",
    "hammering_map": "squealpipe.tasks.hammering",
    "infer_parameters": "squealpipe.tasks.inference",
    "load": "squealpipe.store.netcdf",
    "natural_frequencies": "squealpipe.tasks.linear",
    "periodic_orbit": "squealpipe.tasks.orbits",
    "quasi_static_map": "squealpipe.tasks.linear",
    "refine_validity_map": "squealpipe.tasks.refinement",
    "run_sweep": "squealpipe.tasks.sweep",
    "save": "squealpipe.store.netcdf",
    "simulate": "squealpipe.tasks.dynamics",
    "stability_map": "squealpipe.tasks.linear",
    "summarize": "squealpipe.tasks.summary",
    "validity_map": "squealpipe.tasks.dynamics",
}

__all__ = [
    "SCENES",
    "Parameters",
    "Scene",
    "Sweep",
    "backbone",
    "choose_model",
    "hammering_map",
    "infer_parameters",
    "load",
    "natural_frequencies",
    "periodic_orbit",
    "quasi_static_map",
    "refine_validity_map",
    "run_sweep",
    "save",
    "simulate",
    "stability_map",
    "summarize",
    "validity_map",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("squealpipe")
    if name not in _HOME:
        raise AttributeError(f"squealpipe has no {name!r}; it offers {', '.join(sorted(_HOME))}")
    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*_HOME, "__version__"])
