"""Limit cycles of the damped full model over friction, and of the impact oscillator over ω."""

CYCLES = ("limit_F3", "limit_F2d", "branch_F3_down", "branch_F3_up", "branch_flutter", "extremes")


rule follow_cycles:
    output:
        **{name: data(f"cycles/{name}") for name in CYCLES},
    params:
        settings=settings("parameters", "cycles"),
    priority: LONG
    script:
        "../scripts/cycles/follow_cycles.py"


rule follow_impacts:
    output:
        data("impact_branch"),
    script:
        "../scripts/cycles/follow_impacts.py"
