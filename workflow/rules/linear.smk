"""Linear maps, natural frequencies, and the validation by a published model."""


rule map_linear:
    input:
        sources=sources("map_linear"),
    output:
        quasi_static=data("quasi_static_map"),
        stability=data("stability_map"),
        frequencies=data("natural_frequencies"),
        boundaries=data("stability_boundaries"),
        shares=data("linear_shares"),
    params:
        part=part("parameters", "linear"),
    script:
        "../scripts/map_linear.py"


rule validate_mode_coupling:
    input:
        sources=sources("validate_mode_coupling"),
    output:
        data("mode_coupling"),
    script:
        "../scripts/validate_mode_coupling.py"


rule draw_stability:
    input:
        stability=data("stability_map"),
        quasi_static=data("quasi_static_map"),
        boundaries=data("stability_boundaries"),
        shares=data("linear_shares"),
        coupling=data("mode_coupling"),
        sources=sources("draw_stability"),
    output:
        fig06=figure("fig06"),
        static=figure("static_state"),
        plane=figure("stability_plane"),
        shares=figure("linear_shares"),
        coupling=figure("mode_coupling"),
    script:
        "../scripts/draw_stability.py"


rule draw_frequencies:
    input:
        frequencies=data("natural_frequencies"),
        sources=sources("draw_frequencies"),
    output:
        fig08=figure("fig08"),
        fig09=figure("fig09"),
        shift=figure("frequency_shift"),
    script:
        "../scripts/draw_frequencies.py"


rule draw_linear_against_nonlinear:
    input:
        validity=data("validity_map"),
        sources=sources("draw_linear_against_nonlinear"),
    output:
        figure("linear_against_nonlinear"),
    script:
        "../scripts/draw_linear_against_nonlinear.py"
