"""Periodic motions of model A4: backbones, harmonic balance against exact orbits."""

BACKBONE_SCENES = ["F10", "F11", "F12", "F13", *STUDY.backbones.coupled]
BACKBONES = [f"{scene}_mode{mode}" for scene in BACKBONE_SCENES for mode in (1, 2)]
SERIES = [f"{name}_hbm" for name in BACKBONES]
DOUBLED = [f"{scene}_{number}" for scene in STUDY.backbones.coupled for number in (1, 2)]


rule trace_backbones:
    output:
        **{name: data(f"backbone/{name}") for name in BACKBONES + SERIES},
    params:
        settings=settings(
            "parameters",
            "backbones.coupled",
            "backbones.y_peak_max",
            "backbones.x_amplitude_max",
            "backbones.n_harmonics",
            read_as=READING,
        ),
    priority: LONG
    script:
        "../scripts/backbones/trace_backbones.py"


rule follow_doublings:
    output:
        **{name: data(f"doubled_branch/{name}") for name in DOUBLED},
    params:
        settings=settings(
            "parameters", "backbones.coupled", "backbones.y_peak_max", read_as=READING
        ),
    script:
        "../scripts/backbones/follow_doublings.py"


rule compare_harmonic_forms:
    output:
        data("harmonic_forms"),
    params:
        settings=settings("parameters", "backbones.coupled", read_as=READING),
    script:
        "../scripts/backbones/compare_harmonic_forms.py"


rule compare_a1_with_a4:
    output:
        data("a1_beside_a4"),
    params:
        settings=settings(
            "parameters", "backbones.coupled", "backbones.length_ratios"
        ),
    script:
        "../scripts/backbones/compare_a1_with_a4.py"
