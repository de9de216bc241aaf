"""The study: every dataset, figure and the report, from one configuration."""

from squealpipe.config import PAPER, parse_study, read_study

read_study(PAPER, *workflow.configfiles)  # every mistake in the files, with its line, at once

configfile: PAPER

STUDY = parse_study(config)
RESULTS = STUDY.results

include: "workflow/rules/common.smk"
include: "workflow/rules/scatter.smk"
include: "workflow/rules/model.smk"
include: "workflow/rules/linear.smk"
include: "workflow/rules/dynamics.smk"
include: "workflow/rules/gather.smk"
include: "workflow/rules/inference.smk"
include: "workflow/rules/backbones.smk"
include: "workflow/rules/comparison.smk"
include: "workflow/rules/assumptions.smk"
include: "workflow/rules/explorer.smk"
include: "workflow/rules/animation.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/sweeps.smk"
include: "workflow/rules/local.smk"


rule all:
    default_target: True
    input:
        TARGETS,
