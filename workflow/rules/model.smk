"""The model itself."""


rule draw_fig01:
    input:
        sources=sources("draw_fig01"),
    output:
        figure("fig01"),
    script:
        "../scripts/draw_fig01.py"
