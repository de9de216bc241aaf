"""Numbers of the report's prose, each computed from the datasets of the run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from squealpipe.claims.evidence import Run
from squealpipe.report.facts import comparison, linear, motion, orbits

TOPICS: dict[str, tuple[tuple[str, ...], Callable[[Run], dict[str, Any]]]] = {
    "linear": (("stability_map", "quasi_static_map"), linear.linear),
    "coupling": (("mode_coupling",), linear.coupling),
    "inference": (("parameter_inference",), linear.inference),
    "assumptions": (("assumptions",), motion.assumptions),
    "whirl": (("whirl",), motion.whirl),
    "transient": (("transient",), motion.transient),
    "hammering": (("hammering_map",), motion.hammering),
    "refinement": (("refinement_check",), motion.refinement),
    "orbits": (("orbit_atlas",), orbits.atlas),
    "harmonic": (("harmonic_sweep",), orbits.harmonic),
    "series": (("backbone/F10_mode2_hbm",), orbits.series),
    "failures": (("failure_atlas",), comparison.failures),
    "ladder": (("model_ladder",), comparison.ladder),
    "integration": (("work_precision_integration",), comparison.integration),
}
"""Topic → the datasets that it needs and the function that reads them."""


def gather_facts(run: Run) -> dict[str, Any]:
    """Topic → its numbers, for the topics whose datasets the run has."""
    return {
        topic: make(run)
        for topic, (needed, make) in TOPICS.items()
        if all(name in run for name in needed)
    }
