"""Ctrl-C: stopped within two seconds, what is finished is kept, and the way on is told."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from squealpipe import (
    Parameters,
    Sweep,
    backbone,
    hammering_map,
    load,
    run_sweep,
    simulate,
)
from squealpipe.cli import run
from squealpipe.cli.exit_codes import INTERRUPTED
from squealpipe.cli.project import _patiently

SWEEP = [
    "sweep", "simulate", "--vary", "mu=0.1:0.6:60", "--alpha1", "5pi/6", "--alpha2", "5pi/6",
    "--option", "t_end=20000", "--option", "times=0:20000:11", "-o", "sweep.nc",
]  # fmt: skip
LONG = {
    "simulate": ["simulate", "0.4pi", "0.6pi", "--t-end", "1e6"],
    "map": ["map", "hammering", "--t-end", "3000", "--alpha1", "0:pi:41", "--alpha2", "0:pi:41"],
    "backbone": [
        "backbone",
        "0.3pi",
        "0.9pi",
        "--method",
        "hbm",
        "--n-harmonics",
        "512",
        "--y-peak-max",
        "100",
    ],
    "sweep in processes": [*SWEEP, "--workers", "2"],
    "sweep in this process": [*SWEEP, "--workers", "1"],
}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Compiling is done once, before the stopwatch."""
    simulate(Parameters(), 2.0, 2.5, t_end=1.0)
    hammering_map(Parameters(), [1.0, 2.0], [1.0, 2.0], t_end=1.0)
    backbone(Parameters(), 0.94, 2.83, mode=1, method="hbm", n_harmonics=4, y_peak_max=1.1)
    run_sweep(
        Sweep(
            task="simulate",
            params=Parameters(),
            vary={"mu": [0.1, 0.2]},
            fixed={"alpha1": 2.0, "alpha2": 2.5, "t_end": 1.0, "times": [0.0, 1.0]},
        )
    )
    # an import that is interrupted stays broken for the rest of the process
    importlib.import_module("sympy")


def interrupted_after(seconds, arguments):
    """Exit code, and the seconds from the interrupt to the end."""
    sent = []

    def send():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, send)
    timer.start()
    try:
        code = run(arguments)
        ended = time.perf_counter()
    finally:
        timer.cancel()
    assert sent, "the command ended before the interrupt"
    return code, ended - sent[0]


@pytest.mark.parametrize("name", LONG)
def test_interrupt_stops_within_two_seconds_and_tells_the_way_on(name, capsys, tmp_path):
    code, seconds = interrupted_after(1.5, LONG[name])
    assert code == INTERRUPTED
    assert seconds < 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("squealpipe: interrupted; ")
    assert "run the same command again" in told
    assert not list(tmp_path.glob("[a-z]*"))
    kept = list(tmp_path.rglob("*.npz"))
    assert not list(tmp_path.rglob("*.tmp"))
    assert (f"{len(kept)} finished parts are kept" in told) == bool(kept)


def test_what_was_finished_is_used_and_the_result_is_the_same(tmp_path):
    quick = [item.replace("20000", "300") for item in SWEEP]
    interrupted_after(0.7, [*SWEEP, "--workers", "1"])
    assert run([*quick, "--workers", "1", "-q"]) == 0  # another request: nothing is mixed
    first = load("sweep.nc")
    code, _ = interrupted_after(1.5, [*SWEEP, "--workers", "1", "--force"])
    assert code == INTERRUPTED
    assert load("sweep.nc").identical(first)
    assert list(tmp_path.rglob("*.npz"))
    assert first.sizes["mu"] == 60


BLOCKED = """
import hashlib, os, signal, sys, threading, time
from squealpipe import cli
def blocked(): return hashlib.pbkdf2_hmac('sha256', b'', b'', 2**31 - 1) and 0
cli.COMMANDS['blocked'] = blocked
threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
started = time.perf_counter()
cli.run(['blocked'])
"""


EARLY = """
import runpy, sys
class Interrupt:
    def find_spec(self, name, *_):
        if name == 'cyclopts':
            raise KeyboardInterrupt
sys.meta_path.insert(0, Interrupt())
runpy.run_module('squealpipe', run_name='__main__')
"""


def test_interrupt_while_the_command_is_loaded_is_quiet_too():
    done = subprocess.run(
        [sys.executable, "-c", EARLY], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == INTERRUPTED
    assert done.stderr == "squealpipe: interrupted; nothing was written\n"


def test_compiled_code_that_does_not_return_is_ended_from_outside():
    started = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == INTERRUPTED
    assert done.stderr.startswith("squealpipe: interrupted; nothing was written")
    assert time.perf_counter() - started < 20


def test_a_workflow_that_does_not_heed_an_interrupt_is_ended(monkeypatch):
    monkeypatch.setattr("squealpipe.cli.project.PATIENCE", 2.0)
    head = "import signal, time; signal.signal(2, signal.SIG_IGN); time.sleep(99)"
    threading.Timer(2.0, os.kill, (os.getpid(), signal.SIGINT)).start()
    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        _patiently([sys.executable, "-c", f"import sys; '--unlock' in sys.argv or exec({head!r})"])
    assert time.perf_counter() - started < 20
