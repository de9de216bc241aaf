"""Speed against accuracy, failures, and the model ladder."""


def alone(repeats):
    """All cores for a job whose times are to be quoted; a single repeat is a mere trial."""
    return workflow.cores if repeats > 1 else 1


if PAPERS_FRICTION:

    rule measure_integration:
        input:
            sources=sources("measure_integration"),
        output:
            data("work_precision_integration"),
        params:
            part=part("parameters", "comparison.integration", "comparison.validity"),
        threads: alone(STUDY.comparison.integration.repeats)
        priority: FIRST
        script:
            "../scripts/measure_integration.py"


if PAPERS_FRICTION:

    rule measure_frequencies:
        input:
            sources=sources("measure_frequencies"),
        output:
            data("work_precision_frequencies"),
        params:
            part=part("parameters", "comparison.harmonic", "comparison.onset"),
        threads: alone(STUDY.comparison.harmonic.repeats)
        priority: FIRST
        script:
            "../scripts/measure_frequencies.py"


rule judge_methods:
    input:
        sources=sources("judge_methods"),
    output:
        data("failure_atlas"),
    params:
        part=part("comparison.atlas"),
    priority: LONG
    script:
        "../scripts/judge_methods.py"


LADDER_LEVELS = sorted((ROOT / "squealpipe/tasks/ladder/levels").glob("*.py"))


if PAPERS_FRICTION:

    rule map_model_ladder:
        input:
            sources=sources("map_model_ladder", *LADDER_LEVELS),
        output:
            data("model_ladder"),
        params:
            part=part("parameters", "comparison.ladder"),
        threads: all_cores_for(STUDY.comparison.ladder.points**2, enough=1000) # it quotes times
        priority: FIRST
        script:
            "../scripts/map_model_ladder.py"
