"""The figures of the report, in order, by the part of it that shows them.

The workflow draws exactly these.
"""

from __future__ import annotations

PLACES: dict[str, tuple[str, ...]] = {
    "reach": ("verdict_reach",),
    "asked": ("fig01",),
    "fig02": ("fig02",),
    "fig03": ("fig03",),
    "fig04": ("fig04",),
    "fig05": ("fig05",),
    "fig06": ("fig06",),
    "fig07": ("fig07",),
    "fig08": ("fig08",),
    "fig09": ("fig09",),
    "fig10": ("fig10_to_12",),
    "fig13": ("fig13",),
    "whirl": ("whirl",),
    "transient": ("transient",),
    "black-region": ("refined_boundary",),
    "order": ("frequency_shift",),
    "orbits": (
        "coupled_backbones",
        "harmonic_convergence",
        "harmonic_forms",
        "a1_beside_a4",
    ),
    "atlas": ("orbit_atlas",),
    "cycles": ("cycle_branches", "cycle_multipliers", "cycle_path"),
    "damping": ("critical_friction",),
    "starts": ("basins", "disturbance"),
    "spread": ("propensity",),
    "hammering": ("hammering_map", "predictability"),
    "validation": ("mode_coupling",),
    "speed": (
        "work_precision_time",
        "work_precision_evaluations",
        "work_precision_validity",
        "work_precision_frequencies",
    ),
    "failures": ("failure_atlas",),
    "ladder": ("model_ladder",),
    "parameters": ("parameter_inference",),
}
"""Part of the report (``#pictures("<part>")`` in its templates) → its figures."""

FIGURES = tuple(name for names in PLACES.values() for name in names)
"""All figures, in the order of the report."""
