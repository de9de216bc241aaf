"""Chunks resume after a kill, never mix with others, and tell how far they are."""

import concurrent.futures
import io
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from squealpipe.progress import Progress, counted, duration
from squealpipe.store.chunks import Checkpoint, run_chunks


def square(chunk):
    return {"square": np.asarray(chunk) ** 2}


def test_results_come_in_order_with_and_without_processes():
    chunks = [range(i, i + 3) for i in range(0, 30, 3)]
    expected = [np.arange(i, i + 3) ** 2 for i in range(0, 30, 3)]
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        for executor in (None, pool):
            found = run_chunks(square, chunks, executor=executor)
            for a, b in zip(found, expected, strict=True):
                np.testing.assert_array_equal(a["square"], b)


def test_only_missing_chunks_are_computed_again(tmp_path):
    checkpoint = Checkpoint.beside(tmp_path / "map.nc", key="a1")
    calls = []

    def compute(chunk):
        calls.append(chunk)
        if chunk == 3 and calls.count(3) == 1:
            raise KeyboardInterrupt
        return square(chunk)

    with pytest.raises(KeyboardInterrupt), checkpoint:
        run_chunks(compute, range(5), checkpoint=checkpoint)
    with checkpoint:
        found = run_chunks(compute, range(5), checkpoint=checkpoint)
    assert calls == [0, 1, 2, 3, 3, 4]
    assert [int(item["square"]) for item in found] == [0, 1, 4, 9, 16]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 not a chunk", None])
def test_damaged_chunks_are_computed_again(tmp_path, damage):
    checkpoint = Checkpoint(directory=tmp_path)
    run_chunks(square, [1, 2], checkpoint=checkpoint)
    whole = checkpoint.path(1).read_bytes()
    checkpoint.path(1).write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    found = run_chunks(square, [1, 2], checkpoint=checkpoint)
    assert int(found[1]["square"]) == 4


KILLED = """
import sys, time
from pathlib import Path
import numpy as np
from squealpipe.store.chunks import Checkpoint, run_chunks

def slow(chunk):
    time.sleep(0.02)
    with open(sys.argv[2], "a") as calls:
        calls.write(f"{chunk} ")
    return {"value": np.full(1000, chunk, float)}

found = run_chunks(slow, list(range(20)), checkpoint=Checkpoint(directory=Path(sys.argv[1])))
assert [item["value"][0] for item in found] == list(range(20))
"""


def test_killed_job_goes_on_where_it_was(tmp_path):
    parts, calls = tmp_path / "parts", tmp_path / "calls"
    parts.mkdir()
    command = [sys.executable, "-c", KILLED, str(parts), str(calls)]
    process = subprocess.Popen(command)
    limit = time.monotonic() + 60
    while len(list(parts.glob("*.npz"))) < 5 and time.monotonic() < limit:
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    kept = len(list(parts.glob("*.npz")))
    subprocess.run(command, check=True)
    computed = [int(word) for word in calls.read_text().split()]
    assert 5 <= kept < 20
    assert set(computed) == set(range(20))
    assert len(computed) <= 21, "at most the chunk under way at the kill is computed twice"


def test_progress_tells_rate_and_remaining_time(tmp_path):
    stream, log = io.StringIO(), tmp_path / "job.log"
    with Progress(100, "map", stream=stream, log=log, interval=0.0) as progress:
        progress.started -= 10
        progress.advance(25)
    assert "map: 25 of 100 cells (25%)" in stream.getvalue()
    assert "2.5 cells/s, 30 s left" in log.read_text()
    assert "finished" in log.read_text()


def test_work_kept_from_before_does_not_count_as_fast():
    progress = Progress(100, "map", stream=io.StringIO(), done=50)
    progress.started -= 10
    progress.advance(10)
    assert "1 cells/s, 40 s left" in progress.line()


def test_a_loop_tells_how_far_it_is_and_that_it_was_left(monkeypatch, capsys):
    monkeypatch.setattr("squealpipe.progress.QUIET", -1.0)
    assert list(counted(["a", "b"], "comparison", unit="datasets")) == ["a", "b"]
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("comparison: 1 of 2 datasets (50%)")
    assert told[-1].endswith("finished")
    assert len(told) == 2
    loop = counted(["a", "b", "c"], "comparison", unit="datasets")
    next(loop), next(loop)
    loop.close()
    assert capsys.readouterr().err.splitlines()[-1].endswith("interrupted")


def test_short_jobs_stay_quiet():
    stream = io.StringIO()
    with Progress(2, "map", stream=stream) as progress:
        progress.advance(2)
    assert stream.getvalue() == ""


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.44, "0.4 s"), (17.2, "17 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")]
)
def test_durations_read_well(seconds, text):
    assert duration(seconds) == text
