"""What the model levels take for granted, checked along their motions."""


rule check_assumptions:
    input:
        sources=sources("check_assumptions"),
    output:
        assumptions=data("assumptions"),
        pull=data("linear_pull"),
        reversed=data("simulate/F2a_reversed"),
    params:
        part=part("parameters", "linear.points"),
    script:
        "../scripts/check_assumptions.py"
