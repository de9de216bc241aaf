"""Sweeps of the study: in parts or whole the same bits, and an edit touches its own sweep alone."""

import re

import pytest

from squealpipe.cli import run
from squealpipe.store import load

pytestmark = pytest.mark.release


TINY = "workflow/config/tiny.yaml"
RAGGED = """
sweeps:
  runs:
    task: simulate
    vary: {mu: [0.2, 0.4], alpha1: "1.6,2,5pi/6,2.7"}
    fixed: {alpha2: 5pi/6, t_end: 20}
  maps:
    task: stability_map
    vary: {k3: "0.5:1.5:2:log", alpha2: "0:pi:3"}
    fixed: {alpha1: 72deg}
"""
TWO = """
sweeps:
  friction: {task: stability_map, vary: {mu: "0:0.6:3"}, fixed: {alpha1: 1, alpha2: 2}}
  stiffness: {task: quasi_static_map, vary: {k3: "0.5,1"}, fixed: {alpha1: 1, alpha2: 2}}
"""


def test_parts_equal_the_whole_and_the_command_line(checkout, snakemake, monkeypatch):
    (checkout / "whole.yaml").write_text(RAGGED)
    (checkout / "parts.yaml").write_text(RAGGED + "results: results/parts\n")
    whole = snakemake(checkout, "sweeps", "--configfile", "whole.yaml")
    assert whole.returncode == 0, whole.stderr[-4000:]
    parts = snakemake(checkout, "sweeps", "--configfile", "parts.yaml", "--set-scatter", "maps=3")
    assert parts.returncode == 0, parts.stderr[-4000:]
    for rule, jobs in {"run_sweep_runs": 3, "run_sweep_maps": 3, "join_sweep_maps": 1}.items():
        assert len(re.findall(rf"^Job \d+: {rule} →", parts.stderr, flags=re.MULTILINE)) == jobs
    monkeypatch.chdir(checkout)
    assert run([
        "sweep", "simulate", "--vary", "mu=0.2,0.4", "--vary", "alpha1=1.6,2,5pi/6,2.7",
        "--alpha2", "5pi/6", "--option", "t_end=20", "-o", "runs.nc",
    ]) == 0  # fmt: skip
    for name in ("runs", "maps"):
        found = [load(f"results/{place}data/sweeps/{name}.nc") for place in ("", "parts/")]
        assert len({dataset.attrs["dataset_id"] for dataset in found}) == 1
    assert load("runs.nc").attrs["dataset_id"] == load("results/data/sweeps/runs.nc").dataset_id


@pytest.fixture(scope="module")
def swept(study_copy, snakemake):
    """A finished tiny study with two small sweeps."""
    (study_copy / "two.yaml").write_text(TWO)
    done = snakemake(study_copy, "--configfile", TINY, "two.yaml")
    assert done.returncode == 0, done.stderr[-4000:]
    started = set(re.findall(r"^Job \d+: (\w+)", done.stderr, flags=re.MULTILINE))
    assert started == {"run_sweep_friction", "run_sweep_stiffness", "all"}
    return study_copy


EDITS = {
    "sweeps: {friction: {vary: {mu: [0, 0.3, 0.6]}}}": set(),
    "sweeps: {friction: {vary: {mu: '0:0.6:4'}}}": {"run_sweep_friction"},
    "sweeps: {friction: {fixed: {alpha1: 1.1}}}": {"run_sweep_friction"},
    "sweeps: {friction: {fixed: {mass: 2}}}": {"run_sweep_friction"},
    "sweeps: {stiffness: {vary: {mu: [0.1, 0.2]}}}": {"run_sweep_stiffness"},
    "sweeps: {third: {task: stability_map, vary: {k1: 2}, fixed: {alpha1: 1, alpha2: 2}}}": {
        "run_sweep_third"
    },
    "linear: {points: 91}": set(),
    "parameters: {mu: 0.35}": {"run_sweep_stiffness"},
    "parameters: {k3: 0.8}": {"run_sweep_friction"},
}
"""Overlay → sweeps that it makes stale; of other rules none but for the last three."""


def test_an_edit_makes_its_own_sweep_stale_alone(swept, dry_runs, tmp_path):
    arguments = []
    for number, text in enumerate(EDITS):
        path = tmp_path / f"{number}.yaml"
        path.write_text(text)
        arguments.append(["--configfile", TINY, "two.yaml", path])
    assert dry_runs(swept, [["--configfile", TINY]])[0].rules == set(), "without sweeps"
    for (text, expected), plan in zip(EDITS.items(), dry_runs(swept, arguments), strict=True):
        assert {rule for rule in plan.rules if "_sweep_" in rule} == expected, text
        if text.startswith("sweeps"):
            assert plan.rules == expected, text


def test_plans_that_cannot_work_are_all_told_before_anything_runs(checkout, snakemake):
    (checkout / "bad.yaml").write_text(
        "sweeps:\n"
        "  a: {task: periodic_orbi, vary: {mu: 1}}\n"
        "  b: {task: stability_map, vary: {mu: [-1, 1]}, fixed: {alpha1: 1, alpha2: 1}}\n"
    )
    refused = snakemake(checkout, "--dry-run", "--configfile", "bad.yaml")
    assert refused.returncode != 0
    assert (
        "sweeps.a: no task 'periodic_orbi'; did you mean 'periodic_orbit'"
        in refused.stdout + refused.stderr
    )
    assert "sweeps.b: mu = -1.0: must be 0 or greater" in refused.stdout + refused.stderr
