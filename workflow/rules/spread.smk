"""What the paper leaves out: how far verdicts carry, other starts, uncertain parameters."""

BASINS = ["F2d", "F3"]
DISTURBED = ["F2a", "F2c", "F2d", "F3", "F4", "F5a"]
LEADS_TO = ["contact_lost", "whirl"]


rule judge_reach:
    input:
        **({"inferred": data("parameter_inference")} if PAPERS_FRICTION else {}),
        sources=sources("judge_reach"),
    output:
        data("verdict_reach"),
    params:
        part=part("parameters", "dynamics.tol", "spread.starts"),
    script:
        "../scripts/judge_reach.py"


rule map_basins:
    input:
        sources=sources("map_basins"),
    output:
        **{name: data(f"basin/{name}") for name in BASINS},
    params:
        part=part(
            "parameters", "spread.basin_points", "spread.basin_extent", "spread.basin_horizon"
        ),
    threads: cores_for(STUDY.spread.basin_points**2, enough=2000)
    script:
        "../scripts/map_basins.py"


rule measure_disturbances:
    input:
        sources=sources("measure_disturbances"),
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
        "../scripts/measure_disturbances.py"


rule spread_parameters:
    input:
        sources=sources("spread_parameters"),
    output:
        data("propensity"),
    params:
        part=part(
            "parameters",
            "spread.scene",
            "spread.samples",
            "spread.horizon",
            "spread.spring_correlation",
            "spread.distributions",
        ),
    threads: cores_for(STUDY.spread.samples, enough=1000)
    script:
        "../scripts/spread_parameters.py"
