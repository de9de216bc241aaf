"""How far verdicts carry, and what uncertain parameters lead to."""


rule judge_reach:
    input:
        **({"inferred": data("parameter_inference")} if PAPERS_FRICTION else {}),
    output:
        data("verdict_reach"),
    params:
        part=part("parameters", "dynamics.tol", "spread.starts"),
    script:
        "../scripts/propensity/judge_reach.py"


rule spread_parameters:
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
        "../scripts/propensity/spread_parameters.py"
