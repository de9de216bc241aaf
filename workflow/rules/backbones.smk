"""Periodic motions of model A4: backbones, harmonic balance against exact orbits, the atlas."""

BACKBONE_SCENES = ["F10", "F11", "F12", "F13", *STUDY.backbones.coupled]
BACKBONES = [f"{scene}_mode{mode}" for scene in BACKBONE_SCENES for mode in (1, 2)]
SERIES = [f"{name}_hbm" for name in BACKBONES]


rule trace_backbones:
    input:
        sources=sources("trace_backbones"),
    output:
        **{name: data(f"backbone/{name}") for name in BACKBONES + SERIES},
    params:
        part=part(
            "parameters",
            "backbones.coupled",
            "backbones.y_peak_max",
            "backbones.x_amplitude_max",
            "backbones.n_harmonics",
        ),
    # early, so that it compiles the kernels in a fresh checkout and the jobs below find them
    priority: 1
    script:
        "../scripts/trace_backbones.py"


rule sweep_harmonic_balance:
    input:
        sources=sources("sweep_harmonic_balance"),
    output:
        sweep=data("harmonic_sweep"),
        forms=data("harmonic_forms"),
    params:
        part=part(
            "parameters", "backbones.coupled", "backbones.n_harmonics", "backbones.sweep"
        ),
    script:
        "../scripts/sweep_harmonic_balance.py"


rule compare_a1_with_a4:
    input:
        sources=sources("compare_a1_with_a4"),
    output:
        data("a1_beside_a4"),
    params:
        part=part(
            "parameters", "backbones.coupled", "backbones.length_ratios", "backbones.atlas_peak"
        ),
    script:
        "../scripts/compare_a1_with_a4.py"


rule map_orbits:
    input:
        sources=sources("map_orbits"),
    output:
        data("orbit_atlas"),
    params:
        part=part("parameters", "backbones.atlas_points", "backbones.atlas_peak"),
    threads: cores_for(STUDY.backbones.atlas_points**2, enough=4000)
    script:
        "../scripts/map_orbits.py"


rule draw_backbones:
    input:
        **{name: data(f"backbone/{name}") for name in BACKBONES + SERIES},
        sources=sources("draw_backbones"),
    output:
        fig10=figure("fig10"),
        fig11=figure("fig11"),
        fig12=figure("fig12"),
        fig13=figure("fig13"),
        coupled=figure("coupled_backbones"),
    params:
        part=part("parameters", "backbones.coupled"),
    script:
        "../scripts/draw_backbones.py"


rule draw_orbits:
    input:
        sweep=data("harmonic_sweep"),
        forms=data("harmonic_forms"),
        beside=data("a1_beside_a4"),
        atlas=data("orbit_atlas"),
        sources=sources("draw_orbits"),
    output:
        sweep=figure("harmonic_convergence"),
        forms=figure("harmonic_forms"),
        beside=figure("a1_beside_a4"),
        atlas=figure("orbit_atlas"),
    script:
        "../scripts/draw_orbits.py"
