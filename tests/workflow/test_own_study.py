"""A study of one's own runs the rules that its report needs, and no others."""

from squealpipe.execution.explain import explain
from tests.conftest import ROOT, run_snakemake

OWN = """
paper: false
results: results/own
scenes: {mine: {alpha1: 30deg, alpha2: 140deg}}
"""
RULES = {
    "run_scenes", "map_validity", "follow_boundary", "chart_regimes", "compute_scene_propensity",
    "map_critical_friction",
    "draw_own", "draw_dynamics",
    "draw_linear", "draw_propensity", "write_own_report", "compute_explorer",
    "write_explorer",
}  # fmt: skip


def test_only_the_rules_of_its_report_run_and_only_their_results_are_archived(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    plan = explain([path], directory=tmp_path)
    assert {job.rule for job in plan.jobs} == RULES
    assert {made for job in plan.jobs for made in job.outputs} == set(plan.keys)
    words = ["--directory", str(tmp_path), "--configfile", str(path)]
    run = run_snakemake(ROOT, *words, "--dry-run", "--nocolor")
    wanted = run.stdout.partition("rule all:\n    input: ")[2].partition("\n")[0]
    assert set(wanted.split(", ")) == set(plan.keys), "what is missing of it is made again"
