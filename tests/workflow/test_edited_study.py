"""An edit really run and taken back: what depends on it changes, the rest stays as it is."""

import hashlib
import re
from pathlib import Path

import pytest

from squealpipe.store import load

pytestmark = pytest.mark.release


TINY = "workflow/config/tiny.yaml"
EDIT = "inference: {samples: 600}\n"
STALE = {
    "infer_parameters", "draw_inference", "judge_reach", "draw_propensity", "judge_claims",
    "write_report",
}  # fmt: skip
DATASETS = {"parameter_inference", "verdict_reach", "claims"}
"""What those rules make; the verdicts read the inference, though none may turn over."""


DRAWN = {"parameter_inference", "verdict_reach", "basins", "disturbance", "propensity"}
"""The figures of the two rules that draw."""


def files(results):
    """Path → digest and date of every file."""
    return {
        str(path.relative_to(results)): (
            hashlib.sha256(path.read_bytes()).hexdigest(),
            path.stat().st_mtime_ns,
        )
        for path in results.rglob("*")
        if path.is_file()
    }


def ids(results):
    """Dataset → its id."""
    base = results / "data"
    return {
        str(path.relative_to(base).with_suffix("")): load(path).attrs["dataset_id"]
        for path in base.rglob("*.nc")
    }


def test_an_edit_is_run_and_taken_back(study_copy, snakemake):
    results = study_copy / "results/tiny"

    def run(*configs):
        """Rules that ran, and files whose bytes or date changed."""
        before = files(results)
        done = snakemake(study_copy, "--configfile", TINY, *configs)
        assert done.returncode == 0, done.stderr[-4000:]
        rules = set(re.findall(r"^Job \d+: (\w+) → ", done.stderr, flags=re.MULTILINE))
        after = files(results)
        assert set(after) == set(before)
        return rules - {"all"}, {path for path in after if after[path] != before[path]}

    original, pictures = ids(results), files(results / "figures")
    (study_copy / "edit.yaml").write_text(EDIT)
    rules, changed = run("edit.yaml")
    assert rules == STALE
    assert {path for path in changed if path.startswith("data/")} == {
        f"data/{name}.nc" for name in DATASETS
    }
    drawn = {Path(path).stem for path in changed if path.startswith("figures/")}
    assert {"parameter_inference", "verdict_reach"} <= drawn <= DRAWN
    edited = ids(results)
    assert edited["parameter_inference"] != original["parameter_inference"]
    assert {name for name in original if edited[name] != original[name]} <= DATASETS
    assert load(results / "data/parameter_inference.nc").sizes["sample"] == 600

    rules, _ = run()
    assert rules == STALE
    assert ids(results) == original
    back = files(results / "figures")
    assert {path: digest for path, (digest, _) in back.items()} == {
        path: digest for path, (digest, _) in pictures.items()
    }
    assert run() == (set(), set())
