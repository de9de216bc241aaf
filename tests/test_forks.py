"""Tests that run in forks: none is lost, and what they tell is told."""

import os
import re
import subprocess
import sys

import pytest

LOUD = """
import os, subprocess, threading, warnings

import pytest

def test_output():
    print("printed")
    subprocess.run(["echo", "by a child"])
    assert [1, 2] == [1, 3]

def test_warning():
    class Own(UserWarning): pass
    warnings.warn("careful", Own)

def test_thread():
    thread = threading.Thread(target=lambda: 1 / 0)
    thread.start()
    thread.join()

class Bad:
    def __del__(self): raise ValueError("in vain")

def test_unraisable():
    Bad()

@pytest.fixture(scope="module")
def broken():
    yield
    raise RuntimeError("taken down")

def test_last(broken): pass
"""
CRASHING = """
import os, signal

def test_before(): pass
def test_killed(): os.kill(os.getpid(), signal.SIGKILL)
def test_between(tmp_path): pass
def test_left(): os._exit(0)
"""


def run_in_forks(folder, *words):
    """Run tests in two forks, and return what is printed."""
    options = ("-q", "-p", "tests.forks", "--forks", "2", "-p", "no:cacheprovider")
    run = subprocess.run(
        [sys.executable, "-m", "pytest", *options, "--rootdir", folder, *words, folder],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 1
    return run.stdout


@pytest.mark.release
def test_what_crashes_fails_and_all_others_run_and_tell(tmp_path):
    """Forks take files ahead: that which a crashed one has taken is run by another."""
    for place in range(3):
        (tmp_path / f"test_{place}_crashing.py").write_text(CRASHING)
    (tmp_path / "test_loud.py").write_text(LOUD)
    told = run_in_forks(tmp_path)
    assert "7 failed, 10 passed, 3 warnings, 1 error" in told
    assert (
        len(re.findall("test_killed: its process ended with exit code -9", told)) == 3
    )
    assert len(re.findall("test_left: its process ended with exit code 0", told)) == 3
    shown = ("printed\nby a child", "E       assert [1, 2] == [1, 3]", "Own: careful")
    raised = ("ZeroDivisionError", "ValueError: in vain", "RuntimeError: taken down")
    for words in (*shown, *raised):
        assert words in told


@pytest.mark.release
def test_no_test_begins_after_the_first_failure_where_that_is_asked_for(tmp_path):
    (tmp_path / "test_both.py").write_text(
        "def test_one(): assert 0\ndef test_two(): print(1 / 0)\n"
    )
    assert "1 failed in" in run_in_forks(tmp_path, "-x")
