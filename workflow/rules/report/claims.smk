"""The paper's statements, judged on the datasets of the run. Included after all that make data."""

from squealpipe.paper.claims.datasets import READ_BY_CHECKS

EVIDENCE = [name for folder in SHOWN for name in (f"{folder}{read}" for read in READ_BY_CHECKS) if name in MADE]


rule judge_claims:
    input:
        datasets=[MADE[name]["path"] for name in EVIDENCE],
    output:
        data("claims"),
    params:
        settings=STUDY.slice("parameters", "reading"),
        names=EVIDENCE,
    script:
        "../../scripts/report/judge_claims.py"
