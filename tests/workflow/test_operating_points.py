"""Operating points of a study as jobs of their own: the map of one process, and resumable."""

import pytest
import xarray as xr
import yaml

from squealpipe.cli import run
from squealpipe.store import load
from tests.conftest import ROOT, run_snakemake

OPERATING = {
    "pressure": [0.5, 2.0],
    "speed": "0.5:5:2",
    "mu": [0.05, 0.45],
    "measured": "noises.csv",
}
PARTS = 2


@pytest.mark.release
def test_a_map_in_parts_is_that_of_one_process_after_half_is_deleted(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "noises.csv").write_text("pressure;mu;frequency [Hz]\n2;0.45;1500\n")
    assert run(["init", "pads.yaml", "--structure", "-q"]) == 0
    content = yaml.safe_load((tmp_path / "pads.yaml").read_text())

    def made(name, *options):
        config = tmp_path / f"{name}.yaml"
        results = {"operating": OPERATING, "results": f"results/{name}"}
        config.write_text(yaml.safe_dump(content | results))
        words = ["--directory", str(tmp_path), "--configfile", str(config)]
        target = f"results/{name}/data/structure/operating.nc"
        done = run_snakemake(ROOT, *words, "--cores", "1", *options, target)
        assert done.returncode == 0, done.stderr[-4000:]
        return load(tmp_path / target), done.stdout + done.stderr

    whole, _ = made("whole")
    scatter = ("--set-scatter", f"maps={PARTS}", "--notemp")
    first, said = made("parts", *scatter)
    assert said.count(": map_operating_points →") == PARTS
    (tmp_path / "results/parts/data/structure/operating.nc").unlink()
    (tmp_path / f"results/parts/parts/operating/1-of-{PARTS}.nc").unlink()
    again, said = made("parts", *scatter)
    assert said.count(": map_operating_points →") == PARTS // 2
    assert whole.verdict.size == 8
    assert int(whole.hits) + int(whole.misses) == 1
    for other in (first, again):
        xr.testing.assert_identical(whole.drop_attrs(), other.drop_attrs())
