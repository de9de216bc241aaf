"""Short animations."""


rule animate_scenes:
    input:
        explorer=data("explorer"),
        F3=data("simulate/F3"),
    output:
        hammering=f"{RESULTS}/figures/hammering.gif",
        whirl=f"{RESULTS}/figures/whirl.gif",
    params:
        part=part("animation"),
    script:
        "../../scripts/report/animate_scenes.py"


TARGETS += rules.animate_scenes.output
ANIMATIONS = {
    "hammering at (5π/6, 5π/6)": str(rules.animate_scenes.output.hammering),
    "the motion of Fig. 3": str(rules.animate_scenes.output.whirl),
}
"""What each animation shows, for the report."""
