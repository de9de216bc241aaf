"""Linear maps and natural frequencies."""


rule map_linear:
    input:
        sources=sources("map_linear"),
    output:
        quasi_static=data("quasi_static_map"),
        stability=data("stability_map"),
        frequencies=data("natural_frequencies"),
        boundaries=data("stability_boundaries"),
    params:
        part=part("parameters", "linear.points"),
    script:
        "../scripts/map_linear.py"


rule draw_fig06:
    input:
        stability=data("stability_map"),
        quasi_static=data("quasi_static_map"),
        boundaries=data("stability_boundaries"),
        sources=sources("draw_fig06"),
    output:
        figure("fig06"),
    script:
        "../scripts/draw_fig06.py"


rule draw_frequencies:
    input:
        frequencies=data("natural_frequencies"),
        sources=sources("draw_frequencies"),
    output:
        fig08=figure("fig08"),
        fig09=figure("fig09"),
    script:
        "../scripts/draw_frequencies.py"
