"""Limit cycles of the damped full model and their branches over friction."""

CYCLES = ("limit_F3", "limit_F2d", "branch_F3_down", "branch_F3_up", "branch_flutter", "extremes")


rule follow_cycles:
    output:
        **{name: data(f"cycles/{name}") for name in CYCLES},
    params:
        part=part("parameters", "cycles"),
    priority: LONG
    script:
        "../scripts/cycles/follow_cycles.py"
