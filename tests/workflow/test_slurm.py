"""The study on a real Slurm: the same results, and nothing lost when jobs or the head die.

A running cluster is used where there is one. Otherwise, where Slurm is installed and the tests
are root's, a cluster of one node is started on loopback for the session.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest
import yaml

from squealpipe.store import load
from squealpipe.store.comparison.compare import compare

SCRIPTS = Path(__file__).with_name("slurm")
PROFILE = [
    *("--workflow-profile", "workflow/profiles/slurm", "--set-scatter", "maps=2"),
    *(
        "--slurm-status-command",
        "squeue",
        "--slurm-init-seconds-before-status-checks",
        "1",
    ),
    *("--seconds-between-status-checks", "1", "--latency-wait", "10", "--retries", "0"),
    *("--max-threads", "1", "--default-resources", "runtime=10", "mem_mb_per_cpu=500"),
]
MAP = "results/data/validity_map.nc"
SMALL = """
dynamics: {validity_points: 31, validity_horizon: 20.0}
"""
LONG = """
dynamics: {validity_points: 301, validity_horizon: 200.0}
"""
LACKS_RANK = {"work_precision_frequencies"}
"""Datasets of the paper's Newton method, whose Jacobian lacks rank: round-off alone may change them
from run to run, within the tolerance of the schema."""

SWEEP = """
sweeps:
  orbits:
    task: periodic_orbit
    vary: {mu: "0.1,0.3", y_peak: "1.1:3:5"}
    fixed: {alpha1: 0.3pi, alpha2: 0.9pi, mode: 1}
"""
"""Laid over the tiny study."""
SMALL_RULES = [
    "simulate_scenes",
    "simulate_corrected_scenes",
    "map_linear",
    "map_corrected_linear",
    "refine_validity",
    "follow_whirl",
    "infer_parameters",
    "compare_harmonic_forms",
    "compare_a1_with_a4",
    "follow_cycles",
    "follow_doublings",
    "follow_impacts",
    "map_basins",
    "measure_disturbances",
    "measure_frequencies",
    "check_assumptions",
    "compute_explorer",
    "map_critical_friction",
    "map_model_ladder",
    "trace_backbones",
    "judge_balances",
    "run_benchmark",
    "chart_regimes",
    "compute_propensity",
    "judge_robustness",
    "follow_boundary",
]
TWO_PARTS = [
    *PROFILE,
    *("--set-scatter", "maps=2"),
    *(
        "--groups",
        *(f"{rule}=small" for rule in SMALL_RULES),
        "--group-components",
        "small=3",
    ),
    *(
        "--slurm-init-seconds-before-status-checks",
        "4",
        "--seconds-between-status-checks",
        "4",
    ),
]
"""A job takes about 8 CPU s to start here, so few parts, and three small rules to a job.

Where nothing ended between two looks the plugin waits 10 s longer for the next.
"""
SCATTERED = {
    "map_validity",
    "map_corrected_validity",
    "map_hammering",
    "run_sweep_orbits",
}
JOINS = {
    "join_validity_map",
    "join_corrected_validity_map",
    "join_hammering_map",
    "join_sweep_orbits",
}


def ready():
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
        [SCRIPTS / "up.sh"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert started.returncode == 0, started.stdout + started.stderr
    yield
    subprocess.run([SCRIPTS / "down.sh"], env=environment, check=True)
    shutil.rmtree(base, ignore_errors=True)


def command(*arguments, profile=PROFILE):
    return [
        sys.executable,
        "-m",
        "snakemake",
        *arguments,
        *profile,
        "--configfile",
        "mine.yaml",
    ]


def environment(checkout):
    return {**os.environ, "PYTHONPATH": str(checkout)}


def on_slurm(checkout, *arguments, profile=PROFILE):
    return subprocess.run(
        command(*arguments, profile=profile),
        cwd=checkout,
        env=environment(checkout),
        capture_output=True,
        text=True,
        timeout=1500,
        check=False,
    )


def start(checkout):
    return subprocess.Popen(
        command(MAP),
        cwd=checkout,
        env=environment(checkout),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def jobs(state=""):
    """Ids of jobs in the queue."""
    wanted = ["-t", state] if state else []
    answer = subprocess.run(
        ["squeue", "-h", "-o", "%i", *wanted],
        capture_output=True,
        text=True,
        check=True,
    )
    return answer.stdout.split()


def wait(condition, seconds=120.0):
    """The first true answer of a condition."""
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        answer = condition()
        if answer:
            return answer
        time.sleep(0.2)
    raise AssertionError("waited in vain")


@pytest.fixture(scope="module")
def undisturbed(one_checkout, snakemake):
    """The same map made on this machine, in another results folder."""
    (one_checkout / "local.yaml").write_text(SMALL + "results: results/local\n")
    target = "results/local/data/validity_map.nc"
    run = snakemake(one_checkout, target, "--configfile", "local.yaml")
    assert run.returncode == 0, run.stderr
    return one_checkout / target


@pytest.fixture
def cluster_checkout(one_checkout, slurm):
    for folder in ("results/data", ".snakemake"):
        shutil.rmtree(one_checkout / folder, ignore_errors=True)
    (one_checkout / "mine.yaml").write_text(SMALL)
    return one_checkout


@pytest.mark.timeout(1800)
def test_whole_study_equals_one_machine_bit_for_bit(cluster_checkout, tiny_study):
    """Datasets, figures, report and explorer of the tiny study, maps and a sweep in parts."""
    study = yaml.safe_load((cluster_checkout / "workflow/config/tiny.yaml").read_text())
    study |= {"results": "results/slurm"} | yaml.safe_load(SWEEP)
    (cluster_checkout / "mine.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    run = on_slurm(cluster_checkout, profile=TWO_PARTS)
    assert run.returncode == 0, run.stderr[-4000:]
    sent = Counter(re.findall(r"has been submitted .*/rule_(\w+)/", run.stderr))
    assert {rule for rule, count in sent.items() if count == 2} == SCATTERED
    assert set(sent) >= JOINS
    assert not [rule for rule in sent if rule.startswith(("draw_", "write_", "judge_"))]
    results = cluster_checkout / "results/slurm"
    for name in ("report/index.html", "report/report.pdf", "report/explorer.html"):
        assert (results / name).stat().st_size > 10_000
    assert len(list((results / "figures").glob("*.svg"))) >= 30
    assert "Nothing to be done" in on_slurm(cluster_checkout, profile=TWO_PARTS).stderr

    assert load(results / "data/sweeps/orbits.nc").sizes["mu"] == 2
    shutil.rmtree(results / "data/sweeps")  # in parts or whole: test_sweeps.py
    here = tiny_study.results
    assert compare(here, results).exit_code == 0
    for path in (
        path.relative_to(results) for path in (results / "data").rglob("*.nc")
    ):
        if path.stem not in LACKS_RANK:
            assert load(results / path).dataset_id == load(here / path).dataset_id, path


def test_cancelled_job_fails_and_the_next_run_completes(cluster_checkout, undisturbed):
    (cluster_checkout / "mine.yaml").write_text(LONG)
    head = start(cluster_checkout)
    first = wait(lambda: jobs("R"))[0]
    subprocess.run(["scancel", first], check=True)
    _, errors = head.communicate(timeout=300)
    assert head.returncode != 0
    assert not (cluster_checkout / MAP).exists()
    assert "-of-2" in errors
    (cluster_checkout / "mine.yaml").write_text(SMALL)
    again = on_slurm(cluster_checkout, MAP)
    assert again.returncode == 0, again.stderr[-4000:]
    assert load(cluster_checkout / MAP).sizes["alpha1"] == 31
    assert compare(undisturbed, cluster_checkout / MAP).exit_code == 0


def test_killed_head_loses_nothing(cluster_checkout, undisturbed):
    head = start(cluster_checkout)
    wait(lambda: len(jobs()) >= 2)
    head.send_signal(signal.SIGKILL)
    head.wait()
    wait(lambda: not jobs())
    locked = on_slurm(cluster_checkout, MAP)
    assert locked.returncode != 0
    assert "--unlock" in locked.stderr
    assert on_slurm(cluster_checkout, "--unlock").returncode == 0
    again = on_slurm(cluster_checkout, MAP)
    assert again.returncode == 0, again.stderr[-4000:]
    assert compare(undisturbed, cluster_checkout / MAP).exit_code == 0
