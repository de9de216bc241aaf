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


rule map_linear_shares:
    input:
        sources=sources("map_linear_shares"),
    output:
        data("linear_shares"),
    params:
        part=part("parameters", "linear.share_points", "linear.mu_max", "linear.kappa_max"),
    script:
        "../scripts/map_linear_shares.py"


rule validate_mode_coupling:
    input:
        sources=sources("validate_mode_coupling"),
    output:
        data("mode_coupling"),
    script:
        "../scripts/validate_mode_coupling.py"


rule draw_linear_extras:
    input:
        boundaries=data("stability_boundaries"),
        frequencies=data("natural_frequencies"),
        shares=data("linear_shares"),
        coupling=data("mode_coupling"),
        sources=sources("draw_linear_extras"),
    output:
        plane=figure("stability_plane"),
        shift=figure("frequency_shift"),
        shares=figure("linear_shares"),
        coupling=figure("mode_coupling"),
    script:
        "../scripts/draw_linear_extras.py"


rule draw_linear_against_nonlinear:
    input:
        validity=data("validity_map"),
        sources=sources("draw_linear_against_nonlinear"),
    output:
        figure("linear_against_nonlinear"),
    script:
        "../scripts/draw_linear_against_nonlinear.py"
