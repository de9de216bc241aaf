"""`squealpipe explain` on the real workflow: keys, figures and times of a finished study."""

import pytest

from squealpipe.explain import explain

QUICK = "workflow/config/quick.yaml"


@pytest.fixture
def finished(study_copy, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(study_copy))
    return study_copy


def test_finished_study_has_nothing_to_do(finished):
    assert explain([finished / QUICK], root=finished).jobs == ()


def test_changed_key_is_named_with_what_follows(finished, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("linear: {points: 71}\n")
    plan = explain([finished / QUICK, mine], root=finished)
    jobs = {job.rule: job for job in plan.jobs}
    assert any(reason.startswith("linear.points: ") for reason in jobs["map_linear"].reasons)
    assert "map_linear" in jobs["draw_stability"].follows
    assert "fig06" in plan.figures
    assert "fig02" not in plan.figures
    assert "map_validity" not in jobs
    assert plan.seconds > 0
    assert plan.unknown == []


def test_edited_source_is_named(finished):
    path = finished / "squealpipe/figures/fig06.py"
    text = path.read_text()
    path.write_text(text + "# edited\n")
    try:
        plan = explain([finished / QUICK], root=finished)
    finally:
        path.write_text(text)
    reasons = [reason for job in plan.jobs for reason in job.reasons]
    assert "squealpipe/figures/fig06.py changed" in reasons
    assert "fig06" in plan.figures
