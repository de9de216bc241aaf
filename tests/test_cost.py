"""The check of CPU time beside a stored commit: what it measures, and that it can fail."""

import json
import sys

import pytest

from tests.cost import STORED, command_time, main, study_time, verdict


def test_a_ratio_is_that_of_two_machines_and_fails_above_its_limit(capsys):
    """Twice as slow a machine, on which the study takes as long as it did: half of the work."""
    stored = {
        "commit": "old",
        "calibration": 0.6,
        "study": 400,
        "limits": {"study": 0.55},
    }
    assert verdict("study", 400.0, 1.2, stored)
    assert "0.50 of old" in capsys.readouterr().out
    assert not verdict("study", 400.0, 1.0, stored)


def test_the_time_of_a_command_is_that_of_all_its_processes():
    """Half a second in a child, and half a second in a child of the child."""
    busy = "import time\nwhile time.process_time() < 0.5: pass"
    both = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {busy!r}])\n{busy}"
    assert 1.0 <= command_time([sys.executable, "-c", both]) < 2.0


@pytest.mark.release
def test_a_study_that_costs_more_than_is_stored_is_refused(tmp_path):
    costs = tmp_path / ".snakemake/squealpipe/costs"
    costs.mkdir(parents=True)
    stored = json.loads(STORED.read_text())
    for rule, cpu in (("map", 100.0), ("join", 1e6)):
        record = {"rule": rule, "item": "1-of-1", "cpu": cpu, "compiling": 25.0}
        (costs / f"{rule}.json").write_text(json.dumps(record))
    assert study_time(tmp_path) == 1e6 + 50.0
    assert main("study", str(tmp_path)) == 1
    (costs / "join.json").unlink()
    assert study_time(tmp_path) == 75.0 < stored["limits"]["study"] * stored["study"]
    with pytest.raises(SystemExit, match="no job has run here"):
        study_time(tmp_path / "elsewhere")
