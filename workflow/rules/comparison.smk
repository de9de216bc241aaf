"""Methods compared: speed against accuracy, and where they fail."""


def alone(repeats):
    """All cores for a job whose times are to be quoted; a single repeat is a mere trial."""
    return workflow.cores if repeats > 1 else 1


if PAPERS_FRICTION:

    rule measure_frequencies:
        output:
            data("work_precision_frequencies"),
        params:
            settings=settings("parameters", "comparison.harmonic"),
        threads: alone(STUDY.comparison.harmonic.repeats)
        priority: FIRST
        script:
            "../scripts/comparison/measure_frequencies.py"


rule run_benchmark:
    output:
        data("benchmark"),
    params:
        settings=settings("comparison.benchmark"),
    priority: FIRST
    script:
        "../scripts/comparison/run_benchmark.py"


rule judge_balances:
    output:
        data("failure_atlas"),
    params:
        settings=settings(),
    priority: LONG
    script:
        "../scripts/comparison/judge_balances.py"
