"""The check of CPU time beside a stored commit: what it measures, and that it can fail."""

import json
import os
import subprocess
import sys

import pytest

from squealpipe.study.durations import COSTS_FOLDER
from tests.cost import main, stored_costs, study_time, verdict


def test_a_ratio_is_that_of_two_machines_and_fails_above_its_limit():
    """Twice as slow a machine, on which the study takes as long as it did: half of the work."""
    stored = {
        "commit": "old",
        "calibration": 0.6,
        "study": 400,
        "limits": {"study": 0.55},
    }
    is_allowed, line = verdict("study", 400.0, 1.2, stored)
    assert is_allowed
    assert "0.50 of old" in line
    assert not verdict("study", 400.0, 1.0, stored)[0]


@pytest.mark.release
def test_what_tests_cost_is_told_whether_or_not_it_is_too_much(tmp_path):
    """0.2 s in a process of the tests, and 0.2 s in a child of it."""
    busy = "import time\nwhile time.process_time() < 0.2: pass"
    (tmp_path / "test_busy.py").write_text(
        f"import subprocess, sys\ndef test_busy():\n"
        f"    subprocess.run([sys.executable, '-c', {busy!r}], check=True)\n"
        "    import time\n    end = time.process_time() + 0.2\n"
        "    while time.process_time() < end: pass\n"
    )
    (tmp_path / "limited.py").write_text(
        "import tests.cost as cost\n"
        "stored = {'commit': 'old', 'calibration': 0.6, 'tests': 1.0}\n"
        "cost.stored_costs = lambda: stored | {'limits': {'tests': 1e-6}}\n"
        "cost.calibration = lambda: 0.6\n"
    )
    command = ["-q", "-n", "1", "-p", "limited", "-p", "tests.cost"]
    surroundings = os.environ | {
        "PYTHONPATH": os.pathsep.join([*sys.path, str(tmp_path)])
    }
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *command, "--rootdir", tmp_path, tmp_path],
        cwd=tmp_path,
        env=surroundings,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0
    told, closing = run.stdout.splitlines()[-2:]
    assert closing.startswith("1 passed")
    seconds = float(told.partition(": ")[2].partition(" s")[0])
    assert told.startswith("tests: ")
    assert told.endswith("at most 1e-06")
    assert seconds >= 0.4


def test_a_study_that_costs_more_than_is_stored_or_lacks_jobs_is_refused(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("tests.cost.calibration", lambda: 0.6)
    costs = tmp_path / COSTS_FOLDER
    costs.mkdir(parents=True)
    stored = stored_costs()
    first, *others = stored["rules"]
    for rule in (*others, "assess_structure"):  # the last one is of another study
        record = {"rule": rule, "item": "1-of-1", "cpu": 3.0, "compiling": 2.0}
        (costs / f"{rule}.json").write_text(json.dumps(record))
    with pytest.raises(SystemExit, match=rf"{first} did not run here; run `snakemake`"):
        main(str(tmp_path))
    record = {"rule": first, "item": "1-of-1", "cpu": 1e6, "compiling": 25.0}
    (costs / f"{first}.json").write_text(json.dumps(record))
    assert study_time(tmp_path, stored["rules"]) == 1e6 - 25.0 + len(others)
    assert main(str(tmp_path)) == 1
