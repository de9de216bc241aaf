"""The tiny study end to end, as a user runs it."""

from __future__ import annotations

import re

from squealpipe.parameters import Parameters
from squealpipe.study.report.build import write_document
from squealpipe.study.report.content import Made, gather, picture_files
from squealpipe.study.report.sections import FIGURES

PAPER_FIGURES = [*(f"fig{number:02d}" for number in range(1, 10)), "fig10_to_12", "fig13"]


def test_every_figure_of_the_paper_in_two_forms(tiny_study):
    for name in PAPER_FIGURES:
        for suffix in ("png", "svg"):
            assert (tiny_study.results / "figures" / f"{name}.{suffix}").stat().st_size > 2000


def test_report_is_written(tiny_study):
    for name in ("index", "supplement"):
        text = (tiny_study.results / f"report/{name}.html").read_text(encoding="utf-8")
        assert "</html>" in text


def test_narrative_of_the_shipped_study_fits_its_datasets(tiny_study, tmp_path):
    """Every number is there, and the page has at most 5,000 words."""
    data = tiny_study.results / "data"
    datasets = {
        str(path.relative_to(data).with_suffix("")): Made(path=path, rule="some")
        for path in data.rglob("*.nc")
    }
    figures = {
        name: Made(path=tiny_study.results / f"figures/{name}.png", rule="some", datasets=())
        for name in FIGURES
    }
    content = gather(datasets, figures, Parameters())
    assert set(content["figures"]) == set(FIGURES)
    page = tmp_path / "index.html"
    pictures = picture_files(content, figures)
    write_document("paper", content, pictures, page=page, pdf=tmp_path / "report.pdf")
    text = re.sub(
        r"<style>.*?</style>|<[^>]+>", " ", page.read_text(encoding="utf-8"), flags=re.DOTALL
    )
    words = text.split()
    assert len(words) <= 5000
    assert not {"None", "nan", "NaN"} & set(words)
    assert "nothing ends this" in " ".join(words)


def test_log_of_a_run_has_one_line_a_job(tiny_study):
    text = tiny_study.log
    jobs = re.findall(r"^Job \d+: (\w+) → results/tiny/\S+$", text, flags=re.MULTILINE)
    assert sorted(jobs) == sorted(
        rule
        for rule in re.findall(r"^Finished jobid: \d+ \(Rule: (\w+)\)", text, re.MULTILINE)
        if rule != "all"
    )
    assert not re.search(r"^ +(input|output): ", text, flags=re.MULTILINE)


def test_snakemake_writes_its_own_report(tiny_study, snakemake):
    config = ("--configfile", "workflow/config/tiny.yaml")
    done = snakemake(tiny_study.checkout, *config, "--report", "own.html")
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tiny_study.checkout / "own.html").stat().st_size > 100_000


def test_second_run_has_nothing_to_do(tiny_study, snakemake):
    again = snakemake(tiny_study.checkout, "--configfile", "workflow/config/tiny.yaml")
    assert again.returncode == 0
    assert "Nothing to be done" in again.stderr


def test_only_declared_outputs_are_written(tiny_study, snakemake):
    summary = snakemake(
        tiny_study.checkout, "--configfile", "workflow/config/tiny.yaml", "--summary"
    )
    declared = {line.split("\t")[0] for line in summary.stdout.splitlines()[1:]}
    written = {
        str(path.relative_to(tiny_study.checkout))
        for path in (tiny_study.checkout / "results").rglob("*")
        if path.is_file() and "logs" not in path.parts
    }
    assert written <= declared, sorted(written - declared)
