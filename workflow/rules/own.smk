"""A study of one's own (``paper: false``): its scenes, and what its report needs."""

OWN = list(STUDY.scenes)


rule run_scenes:
    output:
        runs=[data(f"own/{name}") for name in OWN],
        scenes=data("own_scenes"),
    params:
        part=part("parameters", "scenes", "dynamics.tol"),
    script:
        "../scripts/own/run_scenes.py"


rule spread_scene:
    output:
        data("propensity"),
    params:
        part=part(
            "parameters",
            "scenes",
            "spread.samples",
            "spread.horizon",
            "spread.spring_correlation",
            "spread.distributions",
        ),
    threads: cores_for(STUDY.spread.samples, enough=1000)
    script:
        "../scripts/own/spread_scene.py"
