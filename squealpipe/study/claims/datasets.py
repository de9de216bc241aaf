"""Which datasets of a run the checks read; a test holds this list against what they read."""

from __future__ import annotations

from squealpipe.study.claims.checks.misprints import PRINTED

READ = (
    "assumptions",
    "hammering_map",
    "harmonic_forms",
    "linear_pull",
    "natural_frequencies",
    "parameter_inference",
    "quasi_static_map",
    "stability_map",
    "transient",
    "validity_map",
    *(f"simulate/{name}" for name in ("F2a", "F2b", "F2c", "F2d", "F3", "F4", "F5a", "F5b")),
    *(f"simulate/{name}" for name in ("F3_long", "F4_long", PRINTED)),
    *(f"backbone/{name}_mode{mode}" for name in ("F10", "F11", "F12", "F13") for mode in (1, 2)),
)
"""Datasets that the checks read; those of the corrected physics are in a folder of their own."""
