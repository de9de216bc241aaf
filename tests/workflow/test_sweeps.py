"""Sweeps of the study: in parts or whole the same bits, and an edit touches its own sweep alone."""

import shlex

from squealpipe.cli import run
from squealpipe.store import load
from squealpipe.study.explain import explain

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
    parts = snakemake(
        checkout, "sweeps", "--configfile", "parts.yaml", "--set-scatter", "maps=3"
    )
    assert parts.returncode == 0, parts.stderr[-4000:]
    monkeypatch.chdir(checkout)
    assert (
        run(
            shlex.split(
                "sweep simulate --vary mu=0.2,0.4 --vary alpha1=1.6,2,5pi/6,2.7 "
                "--alpha2 5pi/6 --option t_end=20 -o runs.nc"
            )
        )
        == 0
    )
    for name in ("runs", "maps"):
        found = [
            load(f"results/{place}data/sweeps/{name}.nc") for place in ("", "parts/")
        ]
        assert len({dataset.attrs["dataset_id"] for dataset in found}) == 1
    assert (
        load("runs.nc").attrs["dataset_id"]
        == load("results/data/sweeps/runs.nc").dataset_id
    )


EDITS = {
    "sweeps: {friction: {fixed: {alpha1: 1.1}}}": {"run_sweep_friction"},
    # the values of friction are those of before, in other words
    "sweeps: {friction: {vary: {mu: [0, 0.3, 0.6]}}, stiffness: {vary: {mu: [0.1, 0.2]}}}": {
        "run_sweep_stiffness"
    },
    "parameters: {mu: 0.35}": {"run_sweep_stiffness"},
}
"""Overlay → sweeps that it makes stale; of other rules none but for the last."""


def test_an_edit_makes_its_own_sweep_stale_alone(finished, snakemake):
    """The keys of other edits are those of test_config.py."""
    (finished / "two.yaml").write_text(TWO)
    configs = [finished / TINY, finished / "two.yaml"]
    done = snakemake(finished, "--configfile", *configs)
    assert done.returncode == 0, done.stderr[-4000:]
    for text, expected in EDITS.items():
        (finished / "edit.yaml").write_text(text)
        jobs = explain([*configs, finished / "edit.yaml"], directory=finished).jobs
        rules = {job.rule for job in jobs}
        assert {rule for rule in rules if "_sweep_" in rule} == expected, text
        assert rules == expected or text.startswith("parameters"), text
    assert explain([finished / TINY], directory=finished).jobs == []
