"""Methods compared: speed against accuracy, and where they fail."""


def alone(repeats):
    """All cores for a job whose times are to be quoted; a single repeat is a mere trial."""
    return workflow.cores if repeats > 1 else 1


if PAPERS_FRICTION:

    rule measure_integration:
        output:
            data("work_precision_integration"),
        params:
            part=part("parameters", "comparison.integration", "comparison.validity"),
        threads: alone(STUDY.comparison.integration.repeats)
        priority: FIRST
        script:
            "../scripts/comparison/measure_integration.py"

    rule measure_frequencies:
        output:
            data("work_precision_frequencies"),
        params:
            part=part("parameters", "comparison.harmonic", "comparison.onset"),
        threads: alone(STUDY.comparison.harmonic.repeats)
        priority: FIRST
        script:
            "../scripts/comparison/measure_frequencies.py"


rule judge_methods:
    output:
        data("failure_atlas"),
    params:
        part=part("comparison.atlas"),
    priority: LONG
    script:
        "../scripts/comparison/judge_methods.py"
