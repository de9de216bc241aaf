"""Nonlinear runs in time: the scenes of Figs. 2–5, the maps, the whirl."""

from squealpipe.parameters import SCENES

IN_TIME = [scene for scene in SCENES.values() if scene.figure <= 5]


rule simulate_scenes:
    input:
        sources=sources("simulate_scenes"),
    output:
        **{scene.name: data(f"simulate/{scene.name}") for scene in IN_TIME},
    params:
        part=part("parameters", "dynamics.tol"),
    script:
        "../scripts/simulate_scenes.py"


VALIDITY = part("parameters", "dynamics.tol", "dynamics.horizon", "dynamics.validity_points")


rule map_validity:
    input:
        sources=sources("map_validity"),
    output:
        map_output("validity_map", VALIDITY),
    log:
        map_log("validity_map"),
    params:
        part=VALIDITY,
    threads: workflow.cores
    script:
        "../scripts/map_validity.py"


HAMMERING = part("parameters", "dynamics.tol", "dynamics.horizon", "dynamics.hammering_points")


rule map_hammering:
    input:
        sources=sources("map_hammering"),
    output:
        map_output("hammering_map", HAMMERING),
    log:
        map_log("hammering_map"),
    params:
        part=HAMMERING,
    threads: workflow.cores
    script:
        "../scripts/map_hammering.py"


rule draw_scenes:
    input:
        **{scene.name: data(f"simulate/{scene.name}") for scene in IN_TIME},
        sources=sources("draw_scenes"),
    output:
        fig02=figure("fig02"),
        fig03=figure("fig03"),
        fig04=figure("fig04"),
        fig05=figure("fig05"),
    script:
        "../scripts/draw_scenes.py"


rule draw_fig07:
    input:
        validity=data("validity_map"),
        sources=sources("draw_fig07"),
    output:
        figure("fig07"),
    script:
        "../scripts/draw_fig07.py"
