"""Which rules a study has: of one's own, with other friction, from other folders."""

import pytest

from squealpipe.study.explain import explain
from tests.conftest import ROOT, run_snakemake

TINY = "workflow/config/tiny.yaml"
OWN = """
paper: false
results: results/own
scenes: {mine: {alpha1: 30deg, alpha2: 140deg}}
"""
RULES = {
    "assess_scenes",
    "map_verdicts",
    "draw_own",
    "write_own_report",
    "compute_explorer",
    "write_explorer",
}
SCATTERED = {"share_verdicts", "compute_scene_propensity", "draw_propensity"}
"""Rules of a study that configures distributions; none is assumed."""


def test_only_the_rules_of_its_report_run_and_only_their_results_are_archived(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    plan = explain([path], directory=tmp_path)
    assert {job.rule for job in plan.jobs} == RULES
    assert plan.became == []
    spread = "robustness: {distributions: {mu: {distribution: uniform, low: 0.1, high: 0.4}}}"
    scattered = tmp_path / "scattered.yaml"
    scattered.write_text(
        OWN + spread + "\nparameters: {preload_force: 4 kN, k3: 7 kN/mm}"
    )
    with_scatter = explain([scattered], directory=tmp_path)
    assert {job.rule for job in with_scatter.jobs} == RULES | SCATTERED
    assert with_scatter.became == ["preload_force = 4 kN: preload = 0.5714 mm"]
    assert {made for job in plan.jobs for made in job.outputs} == set(plan.keys)
    words = ["--directory", str(tmp_path), "--configfile", str(path)]
    run = run_snakemake(ROOT, *words, "--dry-run", "--nocolor")
    wanted = run.stdout.partition("rule all:\n    input: ")[2].partition("\n")[0]
    assert set(wanted.split(", ")) == set(plan.keys), (
        "what is missing of it is made again"
    )


STUDIES = {
    "dashpots": "parameters: {damping1: 0.02, damping2: 0.02}",
    "law": "parameters: {friction_law: exponential, mu_static: 0.6, friction_speed: 10.0}",
}
NOT_CARRIED = {
    "trace_backbones",
    "follow_doublings",
    "compare_harmonic_forms",
    "compare_a1_with_a4",
    "infer_parameters",
    "map_model_ladder",
    "measure_frequencies",
    "compute_explorer",
    "write_explorer",
    "draw_backbones",
    "draw_inference",
    "check_assumptions",
    "chart_regimes",
}
"""Rules of levels with the paper's friction alone, and what reads nothing but their datasets."""


def test_rules_that_cannot_carry_it_are_left_out_and_all_others_stay(tmp_path):
    def planned(text):
        (tmp_path / "mine.yaml").write_text(text)
        jobs = explain([ROOT / TINY, tmp_path / "mine.yaml"], directory=tmp_path).jobs
        return {job.rule for job in jobs}, {
            path for job in jobs for path in job.outputs
        }

    paper, _ = planned("")
    for name, text in STUDIES.items():
        rules, made = planned(text)
        assert paper - rules == NOT_CARRIED, name
        assert rules < paper, name
        assert {
            "results/tiny/data/stability_map.nc",
            "results/tiny/report/index.html",
        } <= made
        assert "results/tiny/data/natural_frequencies.nc" not in made


@pytest.mark.parametrize("how", ["--snakefile", "--directory"])
def test_a_plan_can_be_made_from_any_folder(how, tmp_path):
    (tmp_path / "mine.yaml").write_text("results: out\n")
    if how == "--snakefile":
        place, words = tmp_path, ["--snakefile", str(ROOT / "Snakefile")]
        config = ["--configfile", str(ROOT / TINY), "mine.yaml"]
    else:
        place, words = ROOT, ["--directory", str(tmp_path)]
        config = ["--configfile", TINY, str(tmp_path / "mine.yaml")]
    done = run_snakemake(
        place, *words, *config, "--nocolor", "-n", "out/data/validity_map.nc"
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "output: out/data/validity_map.nc" in done.stdout
