"""The study: every dataset, figure and the report, from one configuration."""

from squealpipe.config import PAPER, read_study

# Every mistake is told at once, with its file and line.
STUDY = read_study(
    f"{workflow.basedir}/{PAPER}", *workflow.configfiles, changes=workflow.config_settings.config
)
RESULTS = STUDY.results

include: "workflow/rules/common.smk"
include: "workflow/rules/scatter.smk"
include: "workflow/rules/linear.smk"
include: "workflow/rules/dynamics.smk"
include: "workflow/rules/gather.smk"
if PAPERS_FRICTION:
    include: "workflow/rules/inference.smk"
    include: "workflow/rules/backbones.smk"
include: "workflow/rules/cycles.smk"
include: "workflow/rules/spread.smk"
include: "workflow/rules/comparison.smk"
include: "workflow/rules/assumptions.smk"
if PAPERS_FRICTION:
    include: "workflow/rules/explorer.smk"
    include: "workflow/rules/animation.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/sweeps.smk"
include: "workflow/rules/local.smk"


rule all:
    default_target: True
    input:
        TARGETS,
