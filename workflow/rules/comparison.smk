"""Speed against accuracy, failures, and the model ladder."""


rule measure_integration:
    input:
        sources=sources("measure_integration"),
    output:
        data("work_precision_integration"),
    params:
        part=part("parameters", "comparison.integration", "comparison.validity"),
    threads: workflow.cores
    script:
        "../scripts/measure_integration.py"


rule measure_frequencies:
    input:
        sources=sources("measure_frequencies"),
    output:
        data("work_precision_frequencies"),
    params:
        part=part("parameters", "comparison.harmonic", "comparison.onset"),
    threads: workflow.cores
    script:
        "../scripts/measure_frequencies.py"


rule draw_work_precision:
    input:
        integration=data("work_precision_integration"),
        frequencies=data("work_precision_frequencies"),
        sources=sources("draw_work_precision"),
    output:
        time=figure("work_precision_time"),
        evaluations=figure("work_precision_evaluations"),
        validity=figure("work_precision_validity"),
        frequencies=figure("work_precision_frequencies"),
    script:
        "../scripts/draw_work_precision.py"


rule judge_methods:
    input:
        sources=sources("judge_methods"),
    output:
        data("failure_atlas"),
    script:
        "../scripts/judge_methods.py"


rule draw_failure_atlas:
    input:
        atlas=data("failure_atlas"),
        sources=sources("draw_failure_atlas"),
    output:
        figure("failure_atlas"),
    script:
        "../scripts/draw_failure_atlas.py"


rule map_model_ladder:
    input:
        sources=sources("map_model_ladder"),
    output:
        data("model_ladder"),
    params:
        part=part("parameters", "comparison.ladder"),
    threads: workflow.cores
    script:
        "../scripts/map_model_ladder.py"


rule draw_model_ladder:
    input:
        ladder=data("model_ladder"),
        sources=sources("draw_model_ladder"),
    output:
        maps=figure("model_ladder"),
        cost=figure("model_ladder_cost"),
    script:
        "../scripts/draw_model_ladder.py"
