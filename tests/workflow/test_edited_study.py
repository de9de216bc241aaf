"""An edit really run and taken back: what depends on it changes, the rest stays as it is."""

import re

from squealpipe.store import load
from squealpipe.store.whole_files import checksum

TINY = "workflow/config/tiny.yaml"
EDIT = "dynamics: {hammering_points: 12}\n"
STALE = {
    "map_hammering",
    "write_explorer",
    "draw_dynamics",
    "judge_claims",
    "write_report",
}
DATASETS = {"hammering_map", "claims"}
"""What those rules make; the verdicts read the map, though none may turn over."""


def ids(results):
    """Dataset → its id; figure → digest of its bytes."""
    data = results / "data"
    found = {
        path.relative_to(data).with_suffix("").as_posix(): load(path).attrs[
            "dataset_id"
        ]
        for path in data.rglob("*.nc")
    }
    return found, {
        path.name: checksum(path) for path in (results / "figures").iterdir()
    }


def test_an_edit_is_run_and_taken_back(study_copy, snakemake):
    results = study_copy / "results/tiny"

    def run(*configs):
        """Rules that ran, and datasets whose file was written."""
        before = {path: path.stat().st_mtime_ns for path in results.rglob("*.nc")}
        done = snakemake(study_copy, "--configfile", TINY, *configs)
        assert done.returncode == 0, done.stderr[-4000:]
        rules = set(re.findall(r"^Job \d+: (\w+) → ", done.stderr, flags=re.MULTILINE))
        return rules - {"all"}, {
            p.stem for p in before if p.stat().st_mtime_ns != before[p]
        }

    original, pictures = ids(results)
    (study_copy / "edit.yaml").write_text(EDIT)
    assert run("edit.yaml") == (STALE, DATASETS)
    edited, _ = ids(results)
    assert edited["hammering_map"] != original["hammering_map"]
    assert {name for name in original if edited[name] != original[name]} <= DATASETS
    assert load(results / "data/hammering_map.nc").sizes["alpha1"] == 12

    assert run() == (STALE, DATASETS)
    assert ids(results) == (original, pictures)
