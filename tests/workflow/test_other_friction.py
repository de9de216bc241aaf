"""A study with dashpots or another law: what cannot carry them is left out, and named."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.release


ROOT = Path(__file__).resolve().parents[2]
TINY = "workflow/config/tiny.yaml"
STUDIES = {
    "dashpots": "{damping1: 0.02, damping2: 0.02}",
    "law": "{friction_law: exponential, mu_static: 0.6, friction_speed: 10.0}",
}
NOT_CARRIED = {
    "trace_backbones", "follow_doublings", "compare_harmonic_forms", "compare_a1_with_a4",
    "infer_parameters", "map_model_ladder",
    "measure_frequencies", "compute_explorer", "write_explorer",
    "draw_backbones", "draw_inference", "check_assumptions", "chart_regimes",
}  # fmt: skip
"""Rules of levels with the paper's friction alone, and what reads nothing but their datasets."""


@pytest.fixture(scope="module")
def plans(dry_runs, tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies")
    arguments = [["--forceall", "--configfile", TINY]]
    for name, parameters in STUDIES.items():
        overlay = folder / f"{name}.yaml"
        overlay.write_text(f"results: results/tiny\nparameters: {parameters}\n")
        arguments.append(["--forceall", "--configfile", TINY, str(overlay)])
    return dict(zip(("paper", *STUDIES), dry_runs(ROOT, arguments), strict=True))


@pytest.mark.parametrize("name", STUDIES)
def test_rules_that_cannot_carry_it_are_left_out_and_all_others_stay(name, plans):
    assert plans["paper"].rules - plans[name].rules == NOT_CARRIED
    assert plans[name].rules < plans["paper"].rules
    assert "results/tiny/data/natural_frequencies.nc" not in plans[name].text


def test_they_are_named_with_the_remedy(plans):
    words = "Left out, for they carry neither dashpots nor any friction but Coulomb's"
    assert words not in plans["paper"].text
    assert words in plans["dashpots"].text
    assert "Without damping1 = 0.02, damping2 = 0.02 they are part" in plans["dashpots"].text
    assert "Without friction_law = 'exponential', mu_static = 0.6" in plans["law"].text
