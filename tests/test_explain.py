"""The plan in words: rules, keys and sources, figures, and the time that they took before."""

import base64
import io
import json
from dataclasses import replace

import pytest
from rich.console import Console

from squealpipe.execution.explain import (
    Explanation,
    Job,
    Record,
    WorkflowError,
    changed_keys,
    explain,
    job_times,
    read_plan,
    records,
    why,
)
from squealpipe.study.report.explanation import table

PLAN = """
rule map_validity:
    input: squealpipe/laws/springs.py
    output: results/data/validity_map.nc
    jobid: 3
    reason: Params have changed since last execution: Union of exclusive params before and now \
across all output: before: {'validity.points': 61, 'parameters': {'mu': 0.3, 'k1': 1.0}} \
now: {'validity.points': 61, 'parameters': {'mu': 0.4, 'k1': 1.0}}\x20
    threads: 2
    resources: tmpdir=/tmp
[Sat Nov 21 09:43:55 2026]
rule draw_fig07:
    input: results/data/validity_map.nc, squealpipe/study/figures/linear/fig07.py
    output: results/figures/fig07.png, results/figures/fig07.svg
    jobid: 2
    reason: Updated input files: squealpipe/study/figures/linear/fig07.py; Input files updated \
by another job: results/data/validity_map.nc
    resources: tmpdir=/tmp
[Sat Nov 21 09:43:55 2026]
rule draw_fig01:
    output: results/figures/fig01.png
    jobid: 5
    reason: Missing output files: results/figures/fig01.png
rule all:
    input: results/figures/fig07.png
    jobid: 0
    reason: Input files updated by another job: results/figures/fig07.png
"""
KNOWN = {
    "results/data/validity_map.nc": Record(rule="map_validity", seconds=10.0, params=""),
    "results/figures/fig07.png": Record(rule="draw_fig07", seconds=2.0, params=""),
}


def test_plan_names_keys_sources_figures_and_time():
    plan = Explanation(jobs=tuple(read_plan(PLAN, KNOWN)), cores=2)
    assert plan.jobs == (
        Job(
            rule="map_validity",
            outputs=("results/data/validity_map.nc",),
            reasons=("parameters.mu: 0.3 → 0.4",),
            follows=(),
            threads=2,
            seconds=10.0,
        ),
        Job(
            rule="draw_fig07",
            outputs=("results/figures/fig07.png", "results/figures/fig07.svg"),
            reasons=("squealpipe/study/figures/linear/fig07.py changed",),
            follows=("map_validity",),
            seconds=2.0,
        ),
        Job(
            rule="draw_fig01",
            outputs=("results/figures/fig01.png",),
            reasons=("missing: results/figures/fig01.png",),
            follows=(),
        ),
    )
    assert plan.figures == ["fig01", "fig07"]
    assert plan.seconds == 12.0
    assert plan.unknown == ["draw_fig01"]
    assert "never run: draw_fig01" in plan.lines()[-1]
    assert json.loads(json.dumps(plan.as_dict()))["figures"] == ["fig01", "fig07"]


def test_jobs_side_by_side_share_the_cores():
    jobs = tuple(
        Job(rule=f"r{i}", outputs=(f"{i}",), reasons=(), follows=(), seconds=3.0) for i in range(4)
    )
    assert Explanation(jobs=jobs, cores=2).seconds == 6.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("before: {'a': 1} now: {'a': 1, 'b': [2]} ", ["b: absent → [2]"]),
        ("before: <nothing exclusive> now: {'a': 1} ", ["a: absent → 1"]),
        ("before: {'a': nan} now: {'a': 1} ", ["a: absent → 1"]),
        ("something else", ["parameters of the rule changed"]),
    ],
)
def test_changed_keys_from_what_snakemake_says(text, expected):
    assert changed_keys(text) == expected


def test_damaged_records_mean_an_unknown_duration(tmp_path):
    folder = tmp_path / ".snakemake/metadata"
    folder.mkdir(parents=True)
    good = {"rule": "r", "starttime": 1.0, "endtime": 3.5, "params": ["{}"]}
    (folder / base64.b64encode(b"results/a.nc").decode()).write_text(json.dumps(good))
    (folder / base64.b64encode(b"results/b.nc").decode()).write_text("{")
    (folder / "not base64!").write_text("{}")
    assert records(tmp_path) == {"results/a.nc": Record(rule="r", seconds=2.5, params="['{}']")}


def test_many_reasons_are_told_in_short():
    many = ", ".join(f"squealpipe/m{i}.py" for i in range(9))
    text = f"rule r:\n    output: a.nc\n    reason: Updated input files: {many}\n"
    job = read_plan(text, {})[0]
    assert len(job.reasons) == 9
    assert why(job)[3:] == ["squealpipe/m3.py changed", "and 5 more"]
    missing = text.replace("Updated", "Missing output files: a.nc; Updated")
    assert read_plan(missing, {})[0].reasons == ("missing: a.nc",)


def test_nothing_to_do_is_said():
    buffer = io.StringIO()
    Console(file=buffer).print(table(Explanation()))
    assert "nothing to do" in buffer.getvalue()
    assert Explanation().lines() == ["nothing to do: every result is up to date"]


def test_table_shows_rule_reason_and_estimate():
    buffer = io.StringIO()
    plan = Explanation(jobs=tuple(read_plan(PLAN, KNOWN)), cores=2)
    Console(file=buffer, width=120).print(table(plan))
    assert "parameters.mu: 0.3 → 0.4" in buffer.getvalue()
    assert "about 12 s on 2 cores" in buffer.getvalue()


def test_outside_of_a_checkout_or_with_a_broken_workflow(tmp_path):
    with pytest.raises(FileNotFoundError, match="run this in the checkout"):
        explain(root=tmp_path)
    (tmp_path / "Snakefile").write_text("rule all: input: 'nothing-makes-this'")
    config = tmp_path / "workflow/config/paper.yaml"
    config.parent.mkdir(parents=True)
    config.write_text("")
    with pytest.raises(WorkflowError, match="nothing-makes-this"):
        explain(root=tmp_path)


def test_files_of_one_job_count_once():
    written_by = [
        ("draw", 7.0, 50.001),
        ("draw", 7.004, 50.005),
        ("draw", 3.0, 90.0),
        ("map", 7.0, 50.0),
    ]
    known = {
        str(index): Record(rule=rule, seconds=seconds, params="", ended=ended)
        for index, (rule, seconds, ended) in enumerate(written_by)
    }
    assert job_times(known) == {"draw": [7.0, 3.0], "map": [7.0]}


def test_without_any_record_no_time_is_told():
    """Not "about 0.0 s": nothing is known of rules that never ran."""
    jobs = tuple(replace(job, seconds=None) for job in read_plan(PLAN, KNOWN))
    told = Explanation(jobs=jobs, cores=2).estimate()
    assert "not known" in told
    assert "0.0 s" not in told
