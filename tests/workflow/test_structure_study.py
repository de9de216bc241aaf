"""The study of a structure from ``init`` to the report."""

import pytest
import yaml

from squealpipe import load
from squealpipe.cli import run
from squealpipe.study.report import answer, squealing
from tests.conftest import ROOT, run_snakemake, text_of_page

pytestmark = pytest.mark.timeout(1800)


def test_the_report_says_its_onsets_and_its_headline(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["init", "pads.yaml", "--structure"]) == 0
    fewer = tmp_path / "fewer.yaml"
    fewer.write_text(yaml.safe_dump({"structure": {"samples": 4}}))
    configs = [str(tmp_path / "pads.yaml"), str(fewer)]
    words = ["--directory", str(tmp_path), "--configfile", *configs]
    done = run_snakemake(ROOT, *words, "--cores", "1", "--quiet", "all")
    assert done.returncode == 0, done.stderr[-3000:]
    results = tmp_path / "results/pads"
    text = text_of_page(results / "report/index.html")
    told = load(results / "data/structure/squeal.nc")
    assert told.sizes["sample"] == 4
    verdict = load(results / "data/structure/assess.nc")
    said = [answer.headline(verdict), answer.level(verdict), answer.sudden(verdict)]
    for sentence in (*squealing.lines(told)[1:], *said):
        assert sentence in text
    for onset in ("mu = 0.29 on", "0.2901", "mu = 0.408 on", "0.4077"):
        assert onset in text
    assert " nan" not in text
    assert "None" not in text
    assert (results / "report/report.pdf").stat().st_size > 1000
    # its contacts are a table, which has no faces of several points
    assert (results / "data/structure/modes.nc").exists()
    assert not (results / "data/structure/fewer_points.nc").exists()


@pytest.mark.release
@pytest.mark.parametrize(("points", "compared"), [("", True), ("points: 2", False)])
def test_fewer_points_are_compared_where_a_face_has_more_than_two(
    tmp_path, monkeypatch, points, compared
):
    monkeypatch.chdir(tmp_path)
    assert run(["init", "mine.yaml", "--disc"]) == 0
    file = tmp_path / "mine/structure.yaml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("    mu: 0.6", f"    mu: 0.6\n    {points}"))
    words = ["--directory", str(tmp_path), "--configfile", str(tmp_path / "mine.yaml")]
    done = run_snakemake(ROOT, *words, "--dry-run", "all")
    assert done.returncode == 0, done.stderr[-3000:]
    assert "analyse_structure" in done.stdout
    assert ("compare_fewer_points" in done.stdout) == compared
