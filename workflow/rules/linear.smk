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
            # the statements on single scenes are judged there, whatever the grid
            **{
                f"scenes_{name}": data(f"{folder}at_scenes/{name}")
                for name in ("quasi_static_map", "stability_map", "natural_frequencies")
                if STUDY.paper and (PAPERS_FRICTION or name != "natural_frequencies")
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


