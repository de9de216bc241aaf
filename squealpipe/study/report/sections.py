"""Figures of the reports of studies of one's own, in order; the workflow draws exactly these."""

OWN = ("own_settled", "own_phases", "own_map", "own_model", "own_motion", "propensity")
"""Figures of the report of a study of one's own."""

STRUCTURE = (
    *("damping_over_frequency", "modes_and_noise", "motion_phases", "mode_shapes"),
    *("operating_points", "modes_over_friction"),
)
"""Figures of the report of a structure."""
