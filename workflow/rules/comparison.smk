"""Speed against accuracy, failures, and the model ladder."""


def alone(repeats):
    """All cores for a job whose times are to be quoted; a single repeat is a mere trial."""
    return workflow.cores if repeats > 1 else 1


rule measure_integration:
    input:
        sources=sources("measure_integration"),
    output:
        data("work_precision_integration"),
    params:
        part=part("parameters", "comparison.integration", "comparison.validity"),
    threads: alone(STUDY.comparison.integration.repeats)
    script:
        "../scripts/measure_integration.py"


rule measure_frequencies:
    input:
        sources=sources("measure_frequencies"),
    output:
        data("work_precision_frequencies"),
    params:
        part=part("parameters", "comparison.harmonic", "comparison.onset"),
    threads: alone(STUDY.comparison.harmonic.repeats)
    script:
        "../scripts/measure_frequencies.py"


rule judge_methods:
    input:
        sources=sources("judge_methods"),
    output:
        data("failure_atlas"),
    params:
        part=part("comparison.atlas"),
    script:
        "../scripts/judge_methods.py"


rule map_model_ladder:
    input:
        sources=sources("map_model_ladder"),
    output:
        data("model_ladder"),
    params:
        part=part("parameters", "comparison.ladder"),
    threads: cores_for(STUDY.comparison.ladder.points**2, enough=1000)
    script:
        "../scripts/map_model_ladder.py"


rule draw_comparison:
    input:
        integration=data("work_precision_integration"),
        frequencies=data("work_precision_frequencies"),
        atlas=data("failure_atlas"),
        ladder=data("model_ladder"),
        sources=sources("draw_comparison"),
    output:
        work_precision_time=figure("work_precision_time"),
        work_precision_evaluations=figure("work_precision_evaluations"),
        work_precision_validity=figure("work_precision_validity"),
        work_precision_frequencies=figure("work_precision_frequencies"),
        failure_atlas=figure("failure_atlas"),
        model_ladder=figure("model_ladder"),
        model_ladder_cost=figure("model_ladder_cost"),
    script:
        "../scripts/draw_comparison.py"
