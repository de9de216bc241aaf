"""The workflow from other folders."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.release


ROOT = Path(__file__).resolve().parents[2]
TINY = "workflow/config/tiny.yaml"


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
