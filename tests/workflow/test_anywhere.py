"""The workflow from other folders."""

import pytest

from tests.conftest import ROOT, run_snakemake

pytestmark = pytest.mark.release

TINY = "workflow/config/tiny.yaml"


@pytest.mark.parametrize("how", ["--snakefile", "--directory"])
def test_a_plan_can_be_made_from_any_folder(how, tmp_path, monkeypatch):
    (tmp_path / "mine.yaml").write_text("results: out\n")
    if how == "--snakefile":
        place, words = tmp_path, ["--snakefile", str(ROOT / "Snakefile")]
        config = ["--configfile", str(ROOT / TINY), "mine.yaml"]
    else:
        place, words = ROOT, ["--directory", str(tmp_path)]
        config = ["--configfile", TINY, str(tmp_path / "mine.yaml")]
    done = run_snakemake(place, *words, *config, "--nocolor", "-n", "out/data/validity_map.nc")
    assert done.returncode == 0, done.stderr[-2000:]
    assert "output: out/data/validity_map.nc" in done.stdout
