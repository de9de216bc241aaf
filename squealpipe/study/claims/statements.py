"""Every statement, in the paper's order: the paper's own, then our list of its misprints."""

from squealpipe.study.claims.checks import (
    abstract,
    conclusions,
    figures_2_to_5,
    figures_6_and_7,
    figures_8_and_9,
    figures_10_to_13,
    misprints,
)
from squealpipe.study.claims.checks.misprints import PRINTED

PAPER = (
    *abstract.rows,
    *figures_2_to_5.rows,
    *figures_6_and_7.rows,
    *figures_8_and_9.rows,
    *figures_10_to_13.rows,
    *conclusions.rows,
)
"""What the paper says."""

STATEMENTS = (*PAPER, *misprints.rows)
"""Every row of the claims table."""

READ = (
    "assumptions",
    "at_scenes/natural_frequencies",
    "at_scenes/quasi_static_map",
    "at_scenes/stability_map",
    "hammering_map",
    "harmonic_forms",
    "linear_pull",
    "natural_frequencies",
    "parameter_inference",
    "quasi_static_map",
    "stability_map",
    "transient",
    "validity_boundary",
    "validity_map",
    *(
        f"simulate/{name}"
        for name in ("F2a", "F2b", "F2c", "F2d", "F3", "F4", "F5a", "F5b")
    ),
    *(f"simulate/{name}" for name in ("F3_long", "F4_long", PRINTED)),
    *(
        f"backbone/{name}_mode{mode}"
        for name in ("F10", "F11", "F12", "F13")
        for mode in (1, 2)
    ),
)
"""Datasets that the checks read, as a test makes sure; those of the corrected physics are in a
folder of their own."""
