"""Ctrl-C: a command stops within two seconds, quietly, and leaves no file."""

import os
import signal
import subprocess
import sys
import time

import pytest

from squealpipe.cli.console import INTERRUPTED
from squealpipe.cli.project import _to_its_end

LONG = {
    "simulate": ["simulate", "0.4pi", "0.6pi", "--t-end", "1e6"],
    "map": ["map", "hammering", "--t-end", "1e6", "--alpha1", "0:pi:41", "--alpha2", "0:pi:41"],
    "backbone": ["backbone", "0.3pi", "0.9pi", "--method", "hbm", "--n-harmonics", "512",
                 "--y-peak-max", "10000"],
    "sweep": [
        "sweep", "simulate", "--vary", "mu=0.1:0.6:60", "--alpha1", "5pi/6", "--alpha2", "5pi/6",
        "--option", "t_end=1e6", "--option", "times=0:1e6:11", "--workers", "2",
    ],
}  # fmt: skip


SLOW = [pytest.param(name, marks=pytest.mark.release) for name in ("map", "backbone")]


@pytest.mark.parametrize("name", ["simulate", "sweep", *SLOW])
def test_interrupt_stops_the_command_and_its_processes(name, tmp_path):
    """As a terminal sends it: to the whole group."""
    command = [sys.executable, "-m", "squealpipe", *LONG[name]]
    with subprocess.Popen(
        command, cwd=tmp_path, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as done:
        time.sleep(6.0)
        assert done.poll() is None, "the command ended before the interrupt"
        os.killpg(done.pid, signal.SIGINT)
        told = done.communicate(timeout=4.0)[1]
    assert done.returncode == INTERRUPTED
    assert told == "squealpipe: interrupted; run the same command again\n"
    assert not list(tmp_path.iterdir())


def test_a_workflow_is_interrupted_and_waited_for(tmp_path):
    code = (
        "import sys, time\ntry:\n    time.sleep(99)\n"
        "except KeyboardInterrupt:\n    open(sys.argv[1], 'w').close()"
    )
    signal.setitimer(signal.ITIMER_REAL, 2.0)
    before = signal.signal(
        signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT)
    )
    try:
        with pytest.raises(KeyboardInterrupt):
            _to_its_end([sys.executable, "-c", code, str(tmp_path / "tidied")])
    finally:
        signal.signal(signal.SIGALRM, before)
    assert (tmp_path / "tidied").exists()
