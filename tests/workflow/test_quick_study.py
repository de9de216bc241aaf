"""The quick study end to end, as a user runs it."""

from __future__ import annotations

import re

PAPER_FIGURES = [f"fig{number:02d}" for number in range(1, 14)]


def test_every_figure_of_the_paper_in_two_forms(quick_study):
    for name in PAPER_FIGURES:
        for suffix in ("png", "svg"):
            assert (quick_study.results / "figures" / f"{name}.{suffix}").stat().st_size > 2000


def test_report_is_written(quick_study):
    text = (quick_study.results / "report/index.html").read_text(encoding="utf-8")
    assert "</html>" in text


def test_second_run_has_nothing_to_do(quick_study, snakemake):
    again = snakemake(quick_study.checkout, "--configfile", "workflow/config/quick.yaml")
    assert again.returncode == 0
    assert "Nothing to be done" in again.stderr


def test_only_declared_outputs_are_written(quick_study, snakemake):
    summary = snakemake(
        quick_study.checkout, "--configfile", "workflow/config/quick.yaml", "--summary"
    )
    declared = {line.split("\t")[0] for line in summary.stdout.splitlines()[1:]}
    declared |= set(re.findall(r"^\s+log: (.*)$", quick_study.log, flags=re.MULTILINE))
    written = {
        str(path.relative_to(quick_study.checkout))
        for path in (quick_study.checkout / "results").rglob("*")
        if path.is_file() and path.parent.name != "benchmarks"
    }
    assert written <= declared, sorted(written - declared)
