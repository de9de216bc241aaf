"""Names of the datasets that the checks read; the workflow needs nothing else of them."""

PRINTED_SCENE = "F2a_printed"
"""The scene (π/2, π) with the friction of Eq. (4) as printed."""

READ_BY_CHECKS = (
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
    *(f"simulate/{name}" for name in ("F3_long", "F4_long", PRINTED_SCENE)),
    *(
        f"backbone/{name}_mode{mode}"
        for name in ("F10", "F11", "F12", "F13")
        for mode in (1, 2)
    ),
)
"""Datasets that the checks read, as a test makes sure; those of the corrected physics are in a
folder of their own."""
