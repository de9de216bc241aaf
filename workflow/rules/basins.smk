"""Other starts: basins of attraction, and the least disturbance that changes the motion."""

BASINS = ["F2d", "F3"]
DISTURBED = ["F2a", "F2c", "F2d", "F3", "F4", "F5a"]
LEADS_TO = ["contact_lost", "whirl"]


rule map_basins:
    output:
        **{name: data(f"basin/{name}") for name in BASINS},
    params:
        part=part(
            "parameters", "spread.basin_points", "spread.basin_extent", "spread.basin_horizon"
        ),
    threads: cores_for(STUDY.spread.basin_points**2, enough=2000)
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
        part=part(
            "parameters", "spread.disturbance_horizon", "spread.disturbance_directions"
        ),
    script:
        "../scripts/basins/measure_disturbances.py"
