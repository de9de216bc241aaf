"""Linear maps, natural frequencies, and the validation by a published model."""

for folder, reading in SHOWN.items():

    rule:
        name:
            rule_name("map", folder, "linear")
        output:
            quasi_static=data(f"{folder}quasi_static_map"),
            stability=data(f"{folder}stability_map"),
            **{
                name: data(f"{folder}{name}")
                for name in ("natural_frequencies", "stability_boundaries", "linear_pull")
                if PAPERS_FRICTION
            },
        params:
            settings=settings("parameters", "linear.points", read_as=reading),
        script:
            "../scripts/linear/map_linear.py"


rule map_critical_friction:
    output:
        angles=data("critical_friction_map"),
        dashpots=data("critical_damping_map"),
    params:
        settings=settings(
            "parameters",
            "linear.points",
            "robustness.critical_damping",
            "robustness.critical_points",
            "robustness.critical_extent",
            "robustness.scene" if STUDY.paper else "scenes",
        ),
    script:
        "../scripts/linear/map_critical_friction.py"


