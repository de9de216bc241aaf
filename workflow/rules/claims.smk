"""The paper's statements, judged on the datasets of the run. Included after all that make data."""

from squealpipe.report.lineage import lineage

EVIDENCE = {
    name: made["path"]
    for name, made in lineage(workflow.rules, f"{RESULTS}/data/", f"{RESULTS}/figures/")["datasets"].items()
}


rule judge_claims:
    input:
        datasets=list(EVIDENCE.values()),
        sources=sources("judge_claims"),
    output:
        data("claims"),
    params:
        part=part("parameters"),
        names=list(EVIDENCE),
    script:
        "../scripts/judge_claims.py"
