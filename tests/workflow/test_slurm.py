"""The study on a real Slurm: the same results, and nothing lost when jobs or the head die.

A running cluster is used where there is one. Otherwise, where Slurm is installed and the tests
are root's, a cluster of one node is started on loopback for the session.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from squealpipe.store import load
from squealpipe.store.compare import compare

pytestmark = pytest.mark.slurm

SCRIPTS = Path(__file__).with_name("slurm")
PROFILE = [
    *("--workflow-profile", "workflow/profiles/slurm", "--set-scatter", "maps=3"),
    *("--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", "1"),
    *("--seconds-between-status-checks", "1", "--latency-wait", "10", "--retries", "0"),
    *("--max-threads", "1", "--default-resources", "runtime=10", "mem_mb_per_cpu=500"),
]
MAP = "results/data/validity_map.nc"
FIGURE = "results/figures/fig07.png"
SMALL = """
dynamics: {validity_points: 31, validity_horizon: 20.0}
"""
LONG = """
dynamics: {validity_points: 301, validity_horizon: 200.0}
"""


def ready() -> bool:
    answer = subprocess.run(
        ["sinfo", "-h", "-o", "%t"], capture_output=True, text=True, check=False
    )
    return answer.returncode == 0 and bool(answer.stdout.strip())


@pytest.fixture(scope="session")
def slurm():
    if shutil.which("sbatch") is None:
        pytest.skip("sbatch is not installed; as root: tests/workflow/slurm/install.sh")
    if ready():
        yield
        return
    if os.geteuid() != 0 or shutil.which("slurmctld") is None:
        pytest.skip("no Slurm answers, and only root can start one for the tests")
    base = Path(tempfile.mkdtemp(prefix="squealpipe-slurm-"))
    base.chmod(0o755)
    environment = {**os.environ, "SLURM_BASE": str(base)}
    started = subprocess.run(
        [SCRIPTS / "up.sh"], env=environment, capture_output=True, text=True, check=False
    )
    assert started.returncode == 0, started.stdout + started.stderr
    yield
    subprocess.run([SCRIPTS / "down.sh"], env=environment, check=True)
    shutil.rmtree(base, ignore_errors=True)


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "snakemake", *arguments, *PROFILE, "--configfile", "mine.yaml"]


def environment(checkout: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(checkout)}


def on_slurm(checkout: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments),
        cwd=checkout,
        env=environment(checkout),
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )


def jobs(state: str = "") -> list[str]:
    """Ids of jobs in the queue."""
    wanted = ["-t", state] if state else []
    answer = subprocess.run(
        ["squeue", "-h", "-o", "%i", *wanted], capture_output=True, text=True, check=True
    )
    return answer.stdout.split()


def wait(condition, seconds: float = 120.0):
    """The first true answer of a condition."""
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        answer = condition()
        if answer:
            return answer
        time.sleep(0.2)
    raise AssertionError("waited in vain")


def undisturbed(checkout: Path, snakemake) -> Path:
    """The same map made on this machine, in another results folder."""
    local = checkout / "local.yaml"
    local.write_text((checkout / "mine.yaml").read_text() + "results: results/local\n")
    target = "results/local/data/validity_map.nc"
    run = snakemake(checkout, target, "--configfile", "local.yaml")
    assert run.returncode == 0, run.stderr
    return checkout / target


@pytest.fixture
def cluster_checkout(checkout, slurm):
    (checkout / "mine.yaml").write_text(SMALL)
    return checkout


def test_scattered_study_equals_one_machine_bit_for_bit(cluster_checkout, snakemake):
    run = on_slurm(cluster_checkout, MAP, FIGURE)
    assert run.returncode == 0, run.stderr[-4000:]
    assert run.stderr.count("has been submitted with SLURM jobid") == 4
    assert (cluster_checkout / FIGURE).is_file()
    expected = undisturbed(cluster_checkout, snakemake)
    found = cluster_checkout / MAP
    assert compare(expected, found).as_dict()["verdict"] == "equal"
    assert load(found).attrs["dataset_id"] == load(expected).attrs["dataset_id"]
    assert "Nothing to be done" in on_slurm(cluster_checkout, MAP, FIGURE).stderr


def test_cancelled_job_fails_and_the_next_run_completes(cluster_checkout, snakemake):
    (cluster_checkout / "mine.yaml").write_text(LONG)
    head = subprocess.Popen(
        command(MAP),
        cwd=cluster_checkout,
        env=environment(cluster_checkout),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    first = wait(lambda: jobs("R"))[0]
    subprocess.run(["scancel", first], check=True)
    _, errors = head.communicate(timeout=300)
    assert head.returncode != 0
    assert not (cluster_checkout / MAP).exists()
    assert "1-of-3" in errors or "-of-3" in errors
    (cluster_checkout / "mine.yaml").write_text(SMALL)
    again = on_slurm(cluster_checkout, MAP)
    assert again.returncode == 0, again.stderr[-4000:]
    assert load(cluster_checkout / MAP).sizes["alpha1"] == 31
    assert compare(undisturbed(cluster_checkout, snakemake), cluster_checkout / MAP).exit_code == 0


def test_killed_head_loses_nothing(cluster_checkout, snakemake):
    head = subprocess.Popen(
        command(MAP),
        cwd=cluster_checkout,
        env=environment(cluster_checkout),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    wait(lambda: len(jobs()) >= 3)
    head.send_signal(signal.SIGKILL)
    head.wait()
    wait(lambda: not jobs())
    locked = on_slurm(cluster_checkout, MAP)
    assert locked.returncode != 0
    assert "--unlock" in locked.stderr
    assert on_slurm(cluster_checkout, "--unlock").returncode == 0
    again = on_slurm(cluster_checkout, MAP)
    assert again.returncode == 0, again.stderr[-4000:]
    assert compare(undisturbed(cluster_checkout, snakemake), cluster_checkout / MAP).exit_code == 0
