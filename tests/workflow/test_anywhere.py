"""The workflow from other folders, through `squealpipe run`, and before Snakemake's own linter."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.release


ROOT = Path(__file__).resolve().parents[2]
TINY = "workflow/config/tiny.yaml"
EXCEPTIONS = {
    "No log directive defined": "short jobs say nothing unless they fail, and then Snakemake's "
    "own log has the traceback",
    "Specify a conda environment or container for each rule.": "one environment for all rules, "
    "locked with hashes in requirements.lock and made by `make env`",
    "Mixed rules and functions in same snakefile.": "helpers of one topic stand beside its rules; "
    "those of several are in common.smk",
}
"""What `snakemake --lint` says that we leave as it is, and why."""


def snakemake(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-m", "snakemake", "--nocolor", *arguments],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("how", ["--snakefile", "--directory"])
def test_a_plan_can_be_made_from_any_folder(how, tmp_path):
    (tmp_path / "mine.yaml").write_text("results: out\n")
    if how == "--snakefile":
        place, words = tmp_path, ["--snakefile", str(ROOT / "Snakefile")]
        config = ["--configfile", str(ROOT / TINY), "mine.yaml"]
    else:
        place, words = ROOT, ["--directory", str(tmp_path)]
        config = ["--configfile", TINY, str(tmp_path / "mine.yaml")]
    done = snakemake(place, *words, *config, "--dry-run", "out/data/validity_map.nc")
    assert done.returncode == 0, done.stderr[-2000:]
    assert "output: out/data/validity_map.nc" in done.stdout


def test_lint_says_only_what_has_a_reason():
    done = snakemake(ROOT, "--lint")
    told = set(re.findall(r"^ {4}\* (.*?):?$", done.stdout + done.stderr, flags=re.MULTILINE))
    assert told
    assert told <= set(EXCEPTIONS), told - set(EXCEPTIONS)
