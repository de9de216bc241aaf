"""Reproducible computation on friction-induced vibration with contact loss.

Everything public is loaded on first use, so importing one part never costs, nor makes a
workflow depend on, the others.
"""

from __future__ import annotations

import ast
import importlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from squealpipe.execution.sweep import Sweep as Sweep
    from squealpipe.execution.sweep import run_sweep as run_sweep
    from squealpipe.parameters import SCENES as SCENES
    from squealpipe.parameters import Parameters as Parameters
    from squealpipe.parameters import Scene as Scene
    from squealpipe.plotting import plot as plot
    from squealpipe.schema import labels as labels
    from squealpipe.store.netcdf import load as load
    from squealpipe.store.netcdf import save as save
    from squealpipe.store.results import open_results as open_results
    from squealpipe.store.tables import convert as convert
    from squealpipe.systems.system import Switch as Switch
    from squealpipe.systems.system import System as System
    from squealpipe.tasks.backbones.backbone import backbone as backbone
    from squealpipe.tasks.backbones.orbit import periodic_orbit as periodic_orbit
    from squealpipe.tasks.basins.basin import basin_map as basin_map
    from squealpipe.tasks.basins.disturbance import smallest_disturbance as smallest_disturbance
    from squealpipe.tasks.curves.chart import regime_chart as regime_chart
    from squealpipe.tasks.curves.contact import boundary_distance as boundary_distance
    from squealpipe.tasks.curves.contact import contact_boundary as contact_boundary
    from squealpipe.tasks.cycles.branch import cycle_branch as cycle_branch
    from squealpipe.tasks.cycles.curve import cycle_curve as cycle_curve
    from squealpipe.tasks.cycles.cycle import limit_cycle as limit_cycle
    from squealpipe.tasks.dynamics.hammering import hammering_map as hammering_map
    from squealpipe.tasks.dynamics.refinement import refine_validity_map as refine_validity_map
    from squealpipe.tasks.dynamics.runs import simulate as simulate
    from squealpipe.tasks.dynamics.runs import validity_map as validity_map
    from squealpipe.tasks.dynamics.summary import summarize as summarize
    from squealpipe.tasks.inference.inference import infer_parameters as infer_parameters
    from squealpipe.tasks.ladder.choice import choose_model as choose_model
    from squealpipe.tasks.linear.critical import critical_friction_map as critical_friction_map
    from squealpipe.tasks.linear.maps import natural_frequencies as natural_frequencies
    from squealpipe.tasks.linear.maps import quasi_static_map as quasi_static_map
    from squealpipe.tasks.linear.maps import stability_map as stability_map
    from squealpipe.tasks.propensity.propensity import propensity as propensity

_HOME = {
    alias.name: str(node.module)
    for node in ast.walk(ast.parse(Path(__file__).read_bytes()))
    if isinstance(node, ast.ImportFrom) and str(node.module).startswith("squealpipe.")
    for alias in node.names
}
"""Public name → its module, read off the imports above, which only type checkers run."""

__all__ = [*_HOME]  # noqa: PLE0604 (they are texts)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("squealpipe")
    if name not in _HOME:
        raise AttributeError(f"squealpipe has no {name!r}; it offers {', '.join(sorted(_HOME))}")
    return getattr(importlib.import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*_HOME, "__version__"])
