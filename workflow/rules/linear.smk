"""Linear maps, natural frequencies, and the validation by a published model."""

PAPERS_OWN = {
    "frequencies": data("natural_frequencies"),
    "boundaries": data("stability_boundaries"),
} if PAPERS_FRICTION else {}


rule map_linear:
    input:
        sources=sources("linear/map_linear"),
    output:
        quasi_static=data("quasi_static_map"),
        stability=data("stability_map"),
        **PAPERS_OWN,
    params:
        part=part("parameters", "linear"),
    script:
        "../scripts/linear/map_linear.py"


rule map_critical_friction:
    input:
        sources=sources("linear/map_critical_friction"),
    output:
        angles=data("critical_friction_map"),
        dashpots=data("critical_damping_map"),
    params:
        part=part(
            "parameters",
            "linear.points",
            "spread.critical_damping",
            "spread.critical_points",
            "spread.critical_extent",
            "spread.scene",
        ),
    script:
        "../scripts/linear/map_critical_friction.py"


rule validate_mode_coupling:
    input:
        sources=sources("linear/validate_mode_coupling"),
    output:
        data("mode_coupling"),
    script:
        "../scripts/linear/validate_mode_coupling.py"
