"""The study: every dataset, figure and the report, from one configuration."""

from squealpipe.config.settings import PAPER, read_study

# Every mistake is told at once, with its file and line.
STUDY = read_study(
    f"{workflow.basedir}/{PAPER}", *workflow.configfiles, changes=workflow.config_settings.config
)
SHIPPED = read_study(f"{workflow.basedir}/{PAPER}")
RESULTS = STUDY.results

include: "workflow/rules/common.smk"
include: "workflow/rules/execution/scatter.smk"
include: "workflow/rules/linear.smk"
include: "workflow/rules/dynamics.smk"
include: "workflow/rules/execution/gather.smk"
if not STUDY.paper:
    include: "workflow/rules/own.smk"
else:
    if PAPERS_FRICTION:
        include: "workflow/rules/inference.smk"
        include: "workflow/rules/backbones.smk"
    include: "workflow/rules/cycles.smk"
    include: "workflow/rules/spread.smk"
    include: "workflow/rules/starts.smk"
    include: "workflow/rules/comparison.smk"
    if PAPERS_FRICTION:
        include: "workflow/rules/ladder.smk"
    include: "workflow/rules/assumptions.smk"
    if PAPERS_FRICTION:
        include: "workflow/rules/report/explorer.smk"
        include: "workflow/rules/report/animation.smk"
include: "workflow/rules/report/figures.smk"
if STUDY.paper:
    include: "workflow/rules/report/claims.smk"
include: "workflow/rules/report/report.smk"
include: "workflow/rules/execution/sweeps.smk"
include: "workflow/rules/execution/keys.smk"
include: "workflow/rules/execution/local.smk"


rule all:
    default_target: True
    input:
        TARGETS,
