"""A study of one's own (``paper: false``): its scenes, and what its report needs."""

OWN = list(STUDY.scenes)


rule run_scenes:
    output:
        runs=[data(f"own/{name}") for name in OWN],
        scenes=data("own_scenes"),
    params:
        settings=settings("parameters", "scenes", "dynamics.tol"),
    script:
        "../scripts/own/run_scenes.py"


rule compute_scene_propensity:
    output:
        data("propensity"),
    params:
        settings=settings(
            "parameters",
            "scenes",
            "robustness.samples",
            "robustness.horizon",
            "robustness.spring_correlation",
            "robustness.distributions",
        ),
    threads: cores_for(STUDY.robustness.samples, enough=1000)
    script:
        "../scripts/own/compute_scene_propensity.py"
