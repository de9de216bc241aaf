"""Time left, against sums by hand; the line of a rule, by a small workflow of its own."""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

from squealpipe.brake.linear.maps import stability_map
from squealpipe.study import progress
from squealpipe.study.job import Job
from squealpipe.study.progress.remaining import Remaining
from squealpipe.systems.progress import partial_answer
from tests.former import FORMER

WORKFLOW = """
rule all:
    input: expand("{n}.made", n=range(3)), "end"
rule make:
    output: "{n}.made"
    shell: "sleep 0.1; touch {output}"
rule end:
    input: expand("{n}.made", n=range(3))
    output: "end"
    shell: "BROKEN touch {output}"
"""


def test_work_is_shared_by_the_cores_but_the_longest_job_is_waited_for():
    remaining = Remaining(Counter(map=2, draw=1), {"map": 10.0, "draw": 4.0}, cores=2)
    assert remaining.left(0.0) == pytest.approx(12.0)
    remaining.start(1, "map", 0.0)
    remaining.start(2, "map", 0.0)
    assert remaining.left(6.0) == pytest.approx(6.0)  # (24 - 2 × 6) / 2
    remaining.finish(1, 10.0)
    remaining.finish(2, 10.0)
    assert remaining.left(10.0) == pytest.approx(4.0)  # one job, one core


def test_nothing_is_said_before_every_rule_that_is_left_has_run():
    """A disc brake's study had 2 h left by the mean of its rules, and ended after minutes."""
    remaining = Remaining(Counter(map=3, draw=1), {"draw": 2.0}, cores=1)
    assert remaining.words(0.0) == ""
    remaining.start(1, "map", 0.0)
    remaining.finish(1, 5.0)
    assert remaining.left(5.0) == pytest.approx(2 * 5.0 + 2.0)


@pytest.mark.parametrize("quiet", [True, False])
def test_a_long_job_tells_what_it_knows_unless_the_run_is_quiet(
    quiet, tmp_path, monkeypatch, capfd
):
    """A disc brake's study printed nothing between its second rule and its third, for minutes."""
    monkeypatch.setattr("squealpipe.study.progress.log.LOG_EVERY", 0.0)
    if quiet:
        monkeypatch.setenv("SQUEALPIPE_QUIET", "1")
    else:
        monkeypatch.delenv("SQUEALPIPE_QUIET", raising=False)

    def made() -> xr.Dataset:
        partial_answer(lambda: "after a push: squeals")
        return stability_map(FORMER, [1.0, 2.0], [1.0, 2.0])

    given = SimpleNamespace(
        params=SimpleNamespace(key="0" * 16, get=lambda *_: {}),
        wildcards={},
        rule="assess_structure",
        output=[str(tmp_path / "a.nc")],
    )
    for tells in (True, False):
        Job(given, tells=tells).make(made)
    told = "" if quiet else "assess_structure: after a push: squeals\n"
    assert capfd.readouterr().err == told


@pytest.mark.release
@pytest.mark.parametrize("works", [True, False])
def test_a_line_for_each_rule_and_the_log_of_what_failed(works, tmp_path):
    text = WORKFLOW.replace("BROKEN", "" if works else "echo told; false;")
    (tmp_path / "Snakefile").write_text(text)
    command = [sys.executable, "-m", "snakemake", "--cores", "1"]
    command += ["--logger", "squealpipe", "--logger-squealpipe-cores", "1"]
    places = [*progress.__path__, str(Path(__file__).parents[2])]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(places)},
        capture_output=True,
        text=True,
        check=False,
    )
    lines = done.stderr.splitlines()
    assert lines[:2] == ["2 steps", "1 of 2  make"]
    assert lines[2] == "2 of 2  end"
    if works:
        assert done.returncode == 0
        assert len(lines) == 3
    else:
        assert done.returncode == 1
        assert "Error in rule end" in done.stderr
