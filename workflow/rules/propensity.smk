"""How far verdicts carry, and what uncertain parameters lead to."""


rule judge_robustness:
    input:
        **({"inferred": data("parameter_inference")} if PAPERS_FRICTION else {}),
    output:
        data("verdict_robustness"),
    params:
        settings=settings("parameters", "dynamics.tol", "robustness.random_starts"),
    script:
        "../scripts/propensity/judge_robustness.py"


rule compute_propensity:
    output:
        data("propensity"),
    params:
        settings=settings(
            "parameters",
            "robustness.scene",
            "robustness.samples",
            "robustness.horizon",
            "robustness.spring_correlation",
            "robustness.distributions",
        ),
    threads: cores_for(STUDY.robustness.samples, enough=1000)
    script:
        "../scripts/propensity/compute_propensity.py"
