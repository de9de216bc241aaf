"""The study: every dataset, figure and the report, from one configuration."""

from squealpipe.config import parse_study

configfile: "workflow/config/paper.yaml"

STUDY = parse_study(config)
RESULTS = STUDY.results

include: "workflow/rules/common.smk"
include: "workflow/rules/model.smk"
include: "workflow/rules/linear.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"


rule all:
    default_target: True
    input:
        TARGETS,
