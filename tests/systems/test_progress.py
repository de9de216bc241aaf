"""Progress of long commands: how much is done, and where it is shown."""

import contextlib
import os
import pty
import subprocess
import sys

import numpy as np
import pytest

from squealpipe import (
    Parameters,
    backbone,
    basin_map,
    cycle_branch,
    limit_cycle,
    propensity,
)
from squealpipe.systems.compiled import timed_compilation
from squealpipe.systems.progress import alone, report, shown, stage, with_progress
from squealpipe.systems.taylor.lanes import share_of

STICK_SLIP = Parameters(
    friction_law="exponential",
    mu_static=0.6,
    belt_speed=0.5,
    damping1=0.02,
    damping2=0.02,
)
AT = (0.1 * np.pi, 0.5 * np.pi)
LONG = {
    "basin": lambda: basin_map(
        Parameters(), *AT, vx=np.linspace(-5, 5, 300), t_end=300.0, workers=1
    ),
    "propensity": lambda: propensity(
        Parameters(),
        *AT,
        samples=64,
        t_end=300.0,
        workers=1,
        distributions={"mu": {"distribution": "uniform", "low": 0.1, "high": 0.9}},
    ),
    "backbone": lambda: backbone(
        Parameters(), 0.9, 2.8, mode=1, method="hbm", n_harmonics=4
    ),
    "cycle": lambda: limit_cycle(STICK_SLIP, *AT, t_settle=1e4),
    "branch": lambda: cycle_branch(
        STICK_SLIP, *AT, parameter="belt_speed", to=0.6, n_points=12
    ),
}


@pytest.mark.parametrize("name", LONG)
def test_long_tasks_state_how_far_they_are(name):
    shares = []
    with shown(shares.append):
        LONG[name]()
    assert len(set(shares)) > 2
    assert 0.0 <= min(shares) < 0.5 < max(shares) <= 1.0


def test_parts_share_the_whole_and_who_works_alone_shows_for_all():
    shares = []
    with shown(shares.append):
        for _ in with_progress("ab"):
            report(lambda: 0.5)
        with alone() as show:
            report(lambda: 0.1)
            show(1.0)
    report(lambda: 0.2)
    assert shares == [0.0, 0.25, 0.5, 0.75, 1.0]


def test_a_task_that_failed_leaves_no_part_to_the_next():
    """A notebook keeps the error, and with it loops: the next task began at a tenth of a tenth."""
    failed = with_progress(range(10))
    next(failed)
    shares = []
    with shown(shares.append):
        report(lambda: 0.5)
    failed.close()
    assert shares == [0.5]


def test_idle_lanes_have_no_share_of_the_work():
    """Their run ends at 0, which the share of a time is not divided by."""
    job, clock, ends = np.array([0, 1, -1]), np.array([0.5, 1.0, 0.0]), [2.0, 4.0, 0.0]
    with np.errstate(all="raise"):
        done = share_of(job, clock, np.array(ends), np.array([2, 4, 1]))
    # of four jobs two have not begun, and three quarters of two others are left
    assert done == 1.0 - (2.0 + 0.75 + 0.75) / 4.0


def test_who_waits_for_the_compiler_is_told_and_then_where_the_work_stands():
    names, once = [], "compiling, once on this machine"
    with (
        shown(None, None, names.append),
        stage("runs"),
        timed_compilation(),
        timed_compilation(),
    ):
        pass
    assert names == ["runs", once, "runs", ""]


COMMAND = [
    sys.executable,
    "-m",
    "squealpipe",
    "basin",
    "0.4pi",
    "0.6pi",
    "--vx=-5:5:100",
    "--t-end",
    "600",
    "--workers",
    "2",
    "-o",
    "b.nc",
    "--force",
]


@pytest.mark.release
def test_a_terminal_gets_the_time_left_and_a_pipe_nothing(tmp_path):
    short = [word.replace("600", "20") for word in COMMAND]
    done = subprocess.run(short, cwd=tmp_path, capture_output=True, check=True)
    assert done.stderr == b""
    master, slave = pty.openpty()
    surroundings = {**os.environ, "TERM": "xterm", "COLUMNS": "100"}
    with subprocess.Popen(
        COMMAND, cwd=tmp_path, stdout=slave, stderr=slave, env=surroundings
    ):
        os.close(slave)
        text = b""
        with contextlib.suppress(OSError):  # how the end of a terminal reads
            while piece := os.read(master, 4096):
                text += piece
    os.close(master)
    assert b"%" in text
    assert b"0:00:0" in text
