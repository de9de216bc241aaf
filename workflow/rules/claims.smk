"""The paper's statements, judged on the datasets of the run. Included after all that make data."""

from squealpipe.claims.datasets import READ
from squealpipe.report.lineage import lineage

FOUND = lineage(workflow.rules, f"{RESULTS}/data/", f"{RESULTS}/figures/")["datasets"]
EVIDENCE = [name for name in READ if name in FOUND]


rule judge_claims:
    input:
        datasets=[FOUND[name]["path"] for name in EVIDENCE],
        sources=sources("judge_claims"),
    output:
        data("claims"),
    params:
        part=part("parameters"),
        names=EVIDENCE,
    script:
        "../scripts/judge_claims.py"
