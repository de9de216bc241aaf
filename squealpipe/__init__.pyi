from .brake.backbones.backbone import backbone
from .brake.backbones.orbit import periodic_orbit
from .brake.basins.basin import basin_map
from .brake.basins.disturbance import smallest_disturbance
from .brake.curves.chart import regime_chart
from .brake.curves.contact import boundary_distance, contact_boundary
from .brake.cycles.branch import cycle_branch
from .brake.cycles.curve import cycle_curve
from .brake.cycles.cycle import limit_cycle
from .brake.dynamics.hammering import hammering_map
from .brake.dynamics.refinement import refine_validity_map
from .brake.dynamics.runs import simulate, validity_map
from .brake.dynamics.spectrum import spectrum
from .brake.dynamics.summary import summarize
from .brake.ladder.choice import choose_model
from .brake.linear.critical import critical_friction_map
from .brake.linear.maps import natural_frequencies, quasi_static_map, stability_map
from .paper.inference.inference import infer_parameters
from .parameters import SCENES, Parameters, Scene
from .plotting import plot
from .schema import labels
from .store.netcdf import load, save
from .store.results import open_results
from .store.tables import convert
from .structures.assess.operating_map import operating_map
from .structures.contact import Contact
from .structures.meshes.faces import Face, Rotation
from .structures.squeal.ladder import squeal_ladder
from .structures.squeal.squealing_modes import squealing_modes
from .structures.structure import Structure
from .study.assess import assess
from .study.propensity import propensity
from .study.sweep import Sweep, run_sweep
from .systems.components import Component, Switch
from .systems.system import System

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
    "operating_map",
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

__version__: str
