"""A study of one's own runs the rules that its report needs, and no others."""

from __future__ import annotations

OWN = """
paper: false
results: results/own
scenes: {mine: {alpha1: 30deg, alpha2: 140deg}}
"""
RULES = {
    "run_scenes", "map_validity", "spread_scene", "map_critical_friction", "draw_own",
    "draw_linear", "draw_propensity", "write_own_report",
}  # fmt: skip


def test_only_the_rules_of_its_report_run(one_checkout, dry_runs, tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    (plan,) = dry_runs(one_checkout, [["--configfile", path]])
    assert plan.rules - {"all"} == RULES
