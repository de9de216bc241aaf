"""A sweep on the command line that is killed goes on where it was."""

from __future__ import annotations

import subprocess
import sys
import time

from squealpipe import load

COMMAND = [
    sys.executable, "-c", "from squealpipe.cli import main; main()",
    "sweep", "simulate", "--vary", "mu=0.1:0.6:40", "--alpha1", "5pi/6", "--alpha2", "5pi/6",
    "--option", "t_end=300", "--workers", "1", "-o", "sweep.nc",
]  # fmt: skip


def test_killed_sweep_resumes(tmp_path):
    process = subprocess.Popen(COMMAND, cwd=tmp_path, stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while not (parts := list(tmp_path.glob(".sweep.nc.parts/*/*.npz"))):
        assert time.monotonic() < deadline
        assert process.poll() is None
        time.sleep(0.002)
    process.kill()
    process.wait()
    assert not (tmp_path / "sweep.nc").exists()
    kept = {path: path.stat().st_mtime_ns for path in parts}
    again = subprocess.Popen(COMMAND, cwd=tmp_path, stdout=subprocess.DEVNULL)
    while again.poll() is None:
        rewritten = [p for p, made in kept.items() if p.exists() and p.stat().st_mtime_ns != made]
        assert not rewritten
        time.sleep(0.002)
    assert again.returncode == 0
    assert load(tmp_path / "sweep.nc").sizes["mu"] == 40
    assert not (tmp_path / ".sweep.nc.parts").exists()
