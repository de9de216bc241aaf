"""Reproducible computation on friction-induced vibration with contact loss.

Everything public is loaded on first use, so importing one part never costs, nor makes a
workflow depend on, the others.
"""

import ast
import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from squealpipe.brake.assess.assess import assess
    from squealpipe.brake.backbones.backbone import backbone
    from squealpipe.brake.backbones.orbit import periodic_orbit
    from squealpipe.brake.basins.basin import basin_map
    from squealpipe.brake.basins.disturbance import smallest_disturbance
    from squealpipe.brake.curves.chart import regime_chart
    from squealpipe.brake.curves.contact import boundary_distance, contact_boundary
    from squealpipe.brake.cycles.branch import cycle_branch
    from squealpipe.brake.cycles.curve import cycle_curve
    from squealpipe.brake.cycles.cycle import limit_cycle
    from squealpipe.brake.dynamics.hammering import hammering_map
    from squealpipe.brake.dynamics.refinement import refine_validity_map
    from squealpipe.brake.dynamics.runs import simulate, validity_map
    from squealpipe.brake.dynamics.spectrum import spectrum
    from squealpipe.brake.dynamics.summary import summarize
    from squealpipe.brake.ladder.choice import choose_model
    from squealpipe.brake.linear.critical import critical_friction_map
    from squealpipe.brake.linear.maps import (
        natural_frequencies,
        quasi_static_map,
        stability_map,
    )
    from squealpipe.brake.propensity.propensity import propensity
    from squealpipe.paper.inference.inference import infer_parameters
    from squealpipe.parameters import SCENES, Parameters, Scene
    from squealpipe.plotting import plot
    from squealpipe.schema import labels
    from squealpipe.store.netcdf import load, save
    from squealpipe.store.results import open_results
    from squealpipe.store.tables import convert
    from squealpipe.structures.contact import Contact
    from squealpipe.structures.meshes.faces import Face, Rotation
    from squealpipe.structures.squeal.ladder import squeal_ladder
    from squealpipe.structures.squeal.squealing_modes import squealing_modes
    from squealpipe.structures.structure import Structure
    from squealpipe.study.sweep import Sweep, run_sweep
    from squealpipe.systems.components import Component, Switch
    from squealpipe.systems.system import System

HOME = {
    alias.name: str(node.module)
    for node in ast.walk(ast.parse(Path(__file__).read_bytes()))
    if isinstance(node, ast.ImportFrom) and str(node.module).startswith("squealpipe.")
    for alias in node.names
}
"""Public name → its module, read off the imports above, which only type checkers run."""

__all__ = [
    "SCENES",
    "Component",
    "Contact",
    "Face",
    "Parameters",
    "Rotation",
    "Scene",
    "Structure",
    "Sweep",
    "Switch",
    "System",
    "assess",
    "backbone",
    "basin_map",
    "boundary_distance",
    "choose_model",
    "contact_boundary",
    "convert",
    "critical_friction_map",
    "cycle_branch",
    "cycle_curve",
    "hammering_map",
    "infer_parameters",
    "labels",
    "limit_cycle",
    "load",
    "natural_frequencies",
    "open_results",
    "periodic_orbit",
    "plot",
    "propensity",
    "quasi_static_map",
    "refine_validity_map",
    "regime_chart",
    "run_sweep",
    "save",
    "simulate",
    "smallest_disturbance",
    "spectrum",
    "squeal_ladder",
    "squealing_modes",
    "stability_map",
    "summarize",
    "validity_map",
]

MODULES = ("benchmark", "functions", "structures")
"""Public modules that are found without an import of their own."""


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("squealpipe")
    if name in MODULES:
        return importlib.import_module(f"squealpipe.{name}")
    if name not in HOME:
        raise AttributeError(
            f"squealpipe has no {name!r}; it offers {', '.join(sorted(HOME))}"
        )
    return getattr(importlib.import_module(HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*HOME, *MODULES, "__version__"])
