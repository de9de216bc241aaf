"""Other starts: basins of attraction, and the least disturbance that changes the motion."""

BASINS = ["F2d", "F3"]
DISTURBED = ["F2a", "F2c", "F2d", "F3", "F4", "F5a"]
LEADS_TO = ["contact_lost", "whirl"]


rule map_basins:
    output:
        **{name: data(f"basin/{name}") for name in BASINS},
    params:
        settings=settings(
            "parameters", "robustness.basin_points", "robustness.basin_extent", "robustness.basin_horizon"
        ),
    threads: cores_for(STUDY.robustness.basin_points**2, enough=2000)
    script:
        "../scripts/basins/map_basins.py"


rule measure_disturbances:
    output:
        **{
            f"{name}_{goal}": data(f"disturbance/{name}_{goal}")
            for name in DISTURBED
            for goal in LEADS_TO
        },
    params:
        settings=settings(
            "parameters", "robustness.disturbance_horizon", "robustness.disturbance_directions"
        ),
    script:
        "../scripts/basins/measure_disturbances.py"
