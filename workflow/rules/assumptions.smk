"""What the model levels take for granted, checked along their motions."""

# of A4 beside A1, and of undamped A3
LINEAR_CHECKS = {
    "assumptions": data("assumptions"),
    "pull": data("linear_pull"),
} if PAPERS_FRICTION else {}


rule check_assumptions:
    input:
        sources=sources("dynamics/check_assumptions"),
    output:
        **LINEAR_CHECKS,
        reversed=data("simulate/F2a_reversed"),
    params:
        part=part("parameters", "linear.points"),
    script:
        "../scripts/dynamics/check_assumptions.py"
