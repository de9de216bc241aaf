"""A study of one's own (``paper: false``): its scenes, and what its report needs."""

OWN = list(STUDY.scenes)


rule assess_scenes:
    output:
        answers=[data(f"assess/{name}") for name in OWN],
        runs=[data(f"own/{name}") for name in OWN],
        settled=[data(f"settled/{name}") for name in OWN],
    params:
        settings=settings("parameters", "scenes", "dynamics.tol"),
    script:
        "../scripts/own/assess_scenes.py"


rule map_verdicts:
    output:
        data("verdict_map"),
    params:
        settings=settings("parameters", "dynamics.hammering_points"),
    threads: cores_for(STUDY.dynamics.hammering_points**2, enough=900)
    script:
        "../scripts/own/map_verdicts.py"


if STUDY.robustness.distributions:  # no scatter is assumed

    rule share_verdicts:
        output:
            data("verdict_shares"),
        params:
            settings=settings(
                "parameters", "scenes", "robustness.samples", "robustness.distributions"
            ),
        script:
            "../scripts/own/share_verdicts.py"

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
