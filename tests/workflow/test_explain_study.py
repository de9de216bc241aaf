"""`squealpipe explain` on the real workflow: keys, figures and times of a finished study."""

import json
import os

import pytest

from squealpipe.execution.explain import explain
from squealpipe.store import load, save

pytestmark = pytest.mark.release


TINY = "workflow/config/tiny.yaml"


@pytest.fixture
def finished(study_copy, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(study_copy))
    return study_copy


def test_finished_study_has_nothing_to_do(finished):
    assert explain([finished / TINY], root=finished).jobs == ()


def test_changed_key_is_named_with_what_follows(finished, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("linear: {points: 71}\n")
    plan = explain([finished / TINY, mine], root=finished)
    jobs = {job.rule: job for job in plan.jobs}
    assert any(reason.startswith("linear.points: ") for reason in jobs["map_linear"].reasons)
    assert "map_linear" in jobs["draw_linear"].follows
    assert "fig06" in plan.figures
    assert "fig02" not in plan.figures
    assert "map_validity" not in jobs
    assert plan.seconds > 0
    assert plan.unknown == []


def test_edited_source_is_named(finished):
    path = finished / "squealpipe/study/figures/linear/fig06.py"
    text, date = path.read_text(), path.stat().st_mtime
    path.write_text(text + "# edited\n")
    try:
        plan = explain([finished / TINY], root=finished)
    finally:
        path.write_text(text)
        os.utime(path, (date, date))
    reasons = [reason for job in plan.jobs for reason in job.reasons]
    assert "squealpipe/study/figures/linear/fig06.py changed" in reasons
    assert "fig06" in plan.figures


def test_results_without_snakemakes_records_are_held_against_the_study(finished, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("linear: {points: 71}\n")
    records = finished / ".snakemake/metadata"
    aside = records.rename(tmp_path / "metadata")
    try:
        same = explain([finished / TINY], root=finished)
        other = explain([finished / TINY, mine], root=finished)
    finally:
        aside.rename(records)
    assert same.jobs == ()
    reasons = {job.rule: job.reasons for job in other.jobs}
    assert len(reasons["map_linear"]) == 1
    assert reasons["map_linear"][0].startswith("linear.points: ")
    assert "map_validity" not in reasons


def test_copied_dataset_of_another_configuration_is_found(finished):
    path = finished / "results/tiny/data/quasi_static_map.nc"
    whole, date = path.read_bytes(), path.stat().st_mtime
    foreign = load(path)
    told = json.loads(foreign.attrs["config"])
    told["parameters"]["mu"] = 0.123
    save(foreign.assign_attrs(config=json.dumps(told)), path)
    os.utime(path, (date, date))
    try:
        reasons = {job.rule: job.reasons for job in explain([finished / TINY], root=finished).jobs}
    finally:
        path.write_bytes(whole)
        os.utime(path, (date, date))
    assert reasons["map_linear"] == ("parameters.mu: 0.123 → 0.3",)
    assert explain([finished / TINY], root=finished).jobs == ()


def test_source_with_an_older_date_is_noticed(finished):
    path = finished / "squealpipe/laws/springs.py"
    text, date = path.read_text(), path.stat().st_mtime
    path.write_text(text + "ANOTHER = 1\n")
    os.utime(path, (1e9, 1e9))
    try:
        reasons = {job.rule: job.reasons for job in explain([finished / TINY], root=finished).jobs}
    finally:
        path.write_text(text)
        os.utime(path, (date, date))
    assert reasons["map_linear"] == ("squealpipe/laws/springs.py changed",)
    assert "draw_linear" in reasons
