"""Linear maps and natural frequencies."""


rule map_stability:
    input:
        sources=sources("map_stability"),
    output:
        data("stability_map"),
    params:
        part=part("parameters", "linear.points"),
    script:
        "../scripts/map_stability.py"


rule draw_fig06:
    input:
        stability=data("stability_map"),
        sources=sources("draw_fig06"),
    output:
        figure("fig06"),
    script:
        "../scripts/draw_fig06.py"
