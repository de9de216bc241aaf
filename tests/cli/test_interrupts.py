"""Ctrl-C: a command stops within two seconds, quietly, and leaves no file."""

import json
import os
import shlex
import signal
import socket
import subprocess
import sys
import time

import psutil
import pytest

from squealpipe.cli import main
from squealpipe.cli.console import ExitCodes
from squealpipe.study.supervised import end_group, remove_stale_lock

LONG = {
    "simulate": ["simulate", "0.4pi", "0.6pi", "--t-end", "1e6"],
    "map": shlex.split("map hammering --t-end 1e6 --alpha1 0:pi:41 --alpha2 0:pi:41"),
    "backbone": shlex.split(
        "backbone 0.3pi 0.9pi --method hbm --n-harmonics 512 --y-peak-max 10000"
    ),
    "sweep": shlex.split(
        "sweep simulate --vary mu=0.1:0.6:60 --alpha1 5pi/6 --alpha2 5pi/6 "
        "--option t_end=1e6 --option times=0:1e6:11 --workers 2"
    ),
}


LOADED = """
import squealpipe
from squealpipe.cli import main
squealpipe.simulate(squealpipe.Parameters(), 1.0, 2.0, t_end=1.0)
print(flush=True)
main()
"""
"""A command that says when it begins, all libraries loaded."""


@pytest.mark.release
@pytest.mark.parametrize("name", ["simulate", "map", "backbone"])
def test_interrupt_stops_the_command(name, tmp_path):
    command = [sys.executable, "-c", LOADED, *LONG[name]]
    told = interrupted(command, tmp_path, lambda done: done.stdout.readline())
    assert told == "squealpipe: interrupted; nothing was kept\n"


@pytest.mark.release
def test_interrupt_stops_a_sweep_and_its_processes(tmp_path):
    command = [sys.executable, "-m", "squealpipe", *LONG["sweep"]]
    told = interrupted(command, tmp_path, workers_of)
    assert told == "squealpipe: interrupted; run the same command again\n"


def interrupted(command, folder, begins):
    """What a command tells that is interrupted as by a terminal: with its whole group."""
    with subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as done:
        begins(done)
        time.sleep(1.0)
        assert done.poll() is None, "the command ended before the interrupt"
        os.killpg(done.pid, signal.SIGINT)
        told = done.communicate(timeout=4.0)[1]
    assert done.returncode == ExitCodes.interrupted
    assert not list(folder.iterdir())
    return told


def workers_of(sweep):
    """The processes of a sweep, once it has both."""
    process = psutil.Process(sweep.pid)
    wait_until(lambda: len(process.children()) >= 2, 120)
    return [child.pid for child in process.children()]


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_other_signals_that_stop_a_command_leave_no_lock_either(
    name, tmp_path, monkeypatch, capsys
):
    number = getattr(signal, name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "squealpipe.stability_map", lambda *_, **__: signal.raise_signal(number)
    )
    words = ["map", "stability", "--alpha1", "1,2", "--alpha2", "1,2", "-o", "a.nc"]
    monkeypatch.setattr("sys.argv", ["squealpipe", *words])
    before = signal.getsignal(number)
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 128 + number
    told = f"squealpipe: stopped by {name}; nothing was kept\n"
    assert capsys.readouterr().err == told
    assert not list(tmp_path.iterdir())
    assert signal.getsignal(number) is before


HEAD = """
import os, sys
from squealpipe.study.supervised import run_to_its_end
run_to_its_end([sys.executable, "-c", sys.argv[1]], os.environ)
"""
JOB = """
import os, signal, sys, time
worker = os.fork()
if not worker:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    time.sleep(99)
open("started", "w").write(f"{os.getpid()} {worker} ")
try:
    time.sleep(99)
except KeyboardInterrupt:
    open("tidied", "w").close()
    os.kill(worker, signal.SIGTERM)
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_workflow_ends_with_its_head_however_that_ends(name, tmp_path):
    with subprocess.Popen(
        [sys.executable, "-c", HEAD, JOB], cwd=tmp_path, stderr=subprocess.DEVNULL
    ) as head:
        started = tmp_path / "started"
        wait_until(lambda: started.exists() and started.read_text().endswith(" "))
        head.send_signal(getattr(signal, name))
        head.wait(timeout=30)
    numbers = map(int, started.read_text().split())
    wait_until(lambda: not any(map(lives, numbers)))
    assert (tmp_path / "tidied").exists()
    assert bool(list(tmp_path.glob(".snakemake/squealpipe/*"))) is (name == "SIGKILL")


DEAF = "import signal, time; signal.signal(2, signal.SIG_IGN); print(1, flush=True); time.sleep(99)"


def test_a_job_that_does_not_heed_an_interrupt_is_killed(monkeypatch):
    monkeypatch.setattr("squealpipe.study.supervised.PATIENCE", 0.3)
    with subprocess.Popen(
        [sys.executable, "-c", DEAF], stdout=subprocess.PIPE, start_new_session=True
    ) as job:
        try:
            job.stdout.readline()
            end_group(job.pid)
            assert job.wait(timeout=10) == -signal.SIGKILL
        finally:
            job.kill()


def lives(number):
    return psutil.pid_exists(number) and psutil.Process(number).status() != "zombie"


def wait_until(holds, seconds=30):
    until = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < until
        time.sleep(0.1)


def test_the_lock_of_a_killed_run_is_removed_and_said_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lock = tmp_path / ".snakemake/locks/0.output.lock"
    lock.parent.mkdir(parents=True)
    lock.write_text("results/data/a.nc")
    assert remove_stale_lock() == ""  # of a Snakemake that we know nothing of
    holder = tmp_path / ".snakemake/squealpipe/1.json"
    holder.parent.mkdir()
    holder.write_text(json.dumps({"pid": 1, "host": "another"}))
    assert remove_stale_lock() == ""
    holder.write_text(json.dumps({"pid": 99, "host": socket.gethostname()}))
    script = tmp_path / "snakemake"
    script.write_text("import time; time.sleep(99)")
    with subprocess.Popen([sys.executable, str(script)]) as living:
        wait_until(lambda: psutil.Process(living.pid).cmdline()[1:] == [str(script)])
        assert remove_stale_lock() == ""
        living.kill()
    assert "was killed (process 99)" in remove_stale_lock()
    assert not lock.exists()
    assert remove_stale_lock() == ""


@pytest.mark.release
def test_workers_end_with_a_killed_sweep(tmp_path):
    command = [sys.executable, "-m", "squealpipe", *LONG["sweep"]]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL) as sweep:
        try:
            workers = workers_of(sweep)
            time.sleep(1.0)
        finally:  # or it would be waited for
            sweep.kill()
    wait_until(lambda: not any(map(lives, workers)), 5)
