"""Numbers of the report's prose, each computed from the datasets of the run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from squealpipe.study.claims.evidence import Run
from squealpipe.study.report.facts import comparison, cycles, linear, motion, orbits, spread
from squealpipe.study.report.facts.sampling import sampling

TOPICS: dict[str, tuple[tuple[str, ...], Callable[[Run], dict[str, Any]]]] = {
    "linear": (("stability_map", "quasi_static_map"), linear.linear),
    "critical": (("critical_friction_map",), linear.critical),
    "coupling": (("mode_coupling",), linear.coupling),
    "inference": (("parameter_inference",), linear.inference),
    "assumptions": (("assumptions",), motion.assumptions),
    "whirl": (("whirl",), motion.whirl),
    "transient": (("transient",), motion.transient),
    "hammering": (("hammering_map",), motion.hammering),
    "refinement": (("refinement_check", "refined_validity_map"), motion.refinement),
    "orbits": (("orbit_atlas",), orbits.atlas),
    "harmonic": (("harmonic_sweep",), orbits.harmonic),
    "doubled": ((), orbits.doubled),
    "series": (("backbone/F10_mode2_hbm",), orbits.series),
    "reach": (("verdict_reach",), spread.reach),
    "basins": (("basin/F2d", "basin/F3"), spread.basins),
    "disturbances": (("disturbance/F2a_contact_lost",), spread.disturbances),
    "propensity": (("propensity",), spread.propensity),
    "cycles": (("cycles/limit_F3", "cycles/branch_F3_down", "cycles/extremes"), cycles.cycles),
    "failures": (("failure_atlas",), comparison.failures),
    "ladder": (("model_ladder",), comparison.ladder),
    "integration": (("work_precision_integration",), comparison.integration),
    "sampling": ((), sampling),
}
"""Topic → the datasets that it needs and the function that reads them."""


def gather_facts(run: Run) -> dict[str, Any]:
    """Topic → its numbers, for the topics whose datasets the run has."""
    return {
        topic: make(run)
        for topic, (needed, make) in TOPICS.items()
        if all(name in run for name in needed)
    }
