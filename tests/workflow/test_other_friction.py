"""A study with dashpots or another law: the rules that cannot carry them are left out."""

import pytest

from squealpipe.execution.explain import explain
from tests.conftest import ROOT

pytestmark = pytest.mark.release

STUDIES = {
    "dashpots": "parameters: {damping1: 0.02, damping2: 0.02}",
    "law": "parameters: {friction_law: exponential, mu_static: 0.6, friction_speed: 10.0}",
}
NOT_CARRIED = {
    "trace_backbones", "follow_doublings", "compare_harmonic_forms", "compare_a1_with_a4",
    "infer_parameters", "map_model_ladder",
    "measure_frequencies", "compute_explorer", "write_explorer",
    "draw_backbones", "draw_inference", "check_assumptions", "chart_regimes",
}  # fmt: skip
"""Rules of levels with the paper's friction alone, and what reads nothing but their datasets."""


def test_rules_that_cannot_carry_it_are_left_out_and_all_others_stay(tmp_path):
    def planned(text):
        (tmp_path / "mine.yaml").write_text(text)
        configs = [ROOT / "workflow/config/tiny.yaml", tmp_path / "mine.yaml"]
        jobs = explain(configs, directory=tmp_path).jobs
        return {job.rule for job in jobs}, {path for job in jobs for path in job.outputs}

    paper, _ = planned("")
    for name, text in STUDIES.items():
        rules, made = planned(text)
        assert paper - rules == NOT_CARRIED, name
        assert rules < paper, name
        assert {"results/tiny/data/stability_map.nc", "results/tiny/report/index.html"} <= made
        assert "results/tiny/data/natural_frequencies.nc" not in made
