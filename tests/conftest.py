"""Shared fixtures: a copy of the checkout, and one run of the tiny study for all tests."""

import contextlib
import copy
import functools
import gc
import os
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from _pytest.runner import runtestprotocol
from filelock import FileLock

ROOT = Path(__file__).resolve().parents[1]
WATCH = ROOT / "tests/workflow/watch"
READ = "SQUEALPIPE_READ"
"""Environment variable of :data:`WATCH` with the folder for what it sees."""
NOT_COPIED = shutil.ignore_patterns(
    ".git",
    ".venv*",
    ".snakemake",
    "__pycache__",
    ".*_cache",
    ".hypothesis",
    "*.egg-info",
    "build",
)


# A shell that starts the tests in the background makes them and their children ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
# And nohup makes them ignore a hangup, which the tests of interrupted commands send.
signal.signal(signal.SIGHUP, signal.SIG_DFL)
# With more threads for linear algebra small solvers of two test processes wait for one another: a
# search for cycles takes 2.4 times the CPU time. Processes that are started from here inherit it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def copy_checkout(target):
    """A copy of the project without its environment, history and results."""
    shutil.copytree(ROOT, target, ignore=NOT_COPIED, symlinks=True)
    shutil.rmtree(target / "results")
    (target / "results").mkdir()
    return target


def text_of_page(path):
    """The words of a page of HTML, without its tags."""
    page = path.read_text(encoding="utf-8")
    return " ".join(re.sub(r"<[^>]+>", " ", page).split())


def run_snakemake(directory, *arguments, surroundings=None):
    """Run snakemake in a copy, with the package of that copy."""
    env = {**os.environ, "PYTHONPATH": str(directory), **(surroundings or {})}
    return subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=directory,
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )


# A process of the tests holds hundreds of thousands of objects to its end, modules and tests:
# looking for cyclic garbage among them took an eighth of its CPU time.
gc.set_threshold(200_000)


def pytest_runtest_protocol(item, nextitem):
    """A process of pytest-xdist reports a test once, or what went wrong around it.

    Start, set-up, tear-down and end of each of 4,800 tests as messages took 3 s.
    """
    if not hasattr(item.config, "workerinput"):
        return None
    reports = runtestprotocol(item, log=False, nextitem=nextitem)
    total = sum(report.duration for report in reports)
    for report in reports:
        if report.when == "call" or not report.passed:
            report.duration = total
            item.ihook.pytest_runtest_logreport(report=report)
    return True


def pytest_collection_finish():
    """What is loaded by now stays."""
    gc.freeze()


def pytest_itemcollected(item):
    """What is long is not for each change either."""
    if item.get_closest_marker("long"):
        item.add_marker(pytest.mark.release)


def pytest_collection_modifyitems(items):
    """The longest files first, so that all processes end at about the same time."""
    longest = (
        "readme",
        "installation",
        "documentation",
        "quality",
        "own_runs",
        "compiled",
        "random_systems",
        "references",
        "cycle_labels",
        "squealing",
        "other_parameters",
        "reduction",
        "truth",
        "hidden_jumps",
        "contact",
        "assess",
        "inference",
        "settled_disc",
        "captions",
        "branch_ends",
        "damped_chart",
        "special_points",
        "explorer",
        "energy",
        "runs_of_the_whole",
        "backbone",
        "published_cycles",
        "dynamics",
        "modified_disc",
        "confirming",
        "cycles",
        "commands",
        "files",
        "judge",
        "structure",
        "sweep",
        "own",
    )
    places = {f"test_{name}.py": place for place, name in enumerate(longest)}
    items.sort(
        key=lambda item: (
            "workflow" not in item.path.parts,
            places.get(item.path.name, len(places)),
        )
    )


@pytest.fixture(autouse=True, scope="session")
def quick_pictures():
    """Commands draw their pictures, but lay out and write them only where a test looks at them.

    That takes 0.2 s. Files of figures of every kind of dataset are written in tests/paper/figures.
    """
    with pytest.MonkeyPatch.context() as patch:
        from squealpipe.plotting import style

        written = style.save_figure
        patch.setattr(style, "save_figure", _touch)
        yield written


@pytest.fixture
def real_pictures(quick_pictures, monkeypatch):
    """For tests that look at the picture which a command has written."""
    monkeypatch.setattr("squealpipe.plotting.style.save_figure", quick_pictures)


@pytest.fixture(autouse=True, scope="session")
def options_read_once():
    """Help and groups of options are read from their source once, not by each command."""
    with pytest.MonkeyPatch.context() as patch:
        from cyclopts.argument import _collection

        for name in ("extract_docstring_help", "_resolve_groups_from_callable"):
            read = functools.cache(getattr(_collection, name))
            patch.setattr(_collection, name, read)
        yield


@pytest.fixture(autouse=True, scope="session")
def configurations_parsed_once():
    """The same text in YAML, mostly that of the paper's study, is parsed once."""
    with pytest.MonkeyPatch.context() as patch:
        from squealpipe.store import yaml_files

        parsed = functools.cache(yaml_files.parsed)
        patch.setattr(yaml_files, "parsed", lambda text: copy.deepcopy(parsed(text)))
        yield


@pytest.fixture(autouse=True, scope="session")
def one_process():
    """What asks for no number of processes runs in that of the tests, which fill all cores.

    A fork of a process as large takes 30 ms. Tests of ensembles and of processes ask for theirs.
    """
    with pytest.MonkeyPatch.context() as patch:
        from squealpipe.systems import processes

        by_cores = processes.workers_for
        patch.setattr(processes, "workers_for", lambda _: 1)
        yield by_cores


def _touch(_, paths, **__):
    for path in paths:
        Path(path).touch()


@dataclass(frozen=True)
class TinyStudy:
    """A finished tiny study; ``read`` has what each of its scripts read of the checkout."""

    checkout: Path
    results: Path
    read: Path


@pytest.fixture
def checkout(tmp_path):
    """A fresh copy of the project."""
    return copy_checkout(tmp_path / "squealpipe")


@pytest.fixture(scope="session")
def tiny_study(tmp_path_factory, worker_id):
    """The tiny study, run once for all test processes, each of which has a copy to itself.

    Where ``SQUEALPIPE_TINY`` names a folder, it is kept there for the tiers that follow.
    """
    own = tmp_path_factory.getbasetemp()
    shared = Path(
        os.environ.get("SQUEALPIPE_TINY", own if worker_id == "master" else own.parent)
    )
    shared.mkdir(exist_ok=True)
    original, done = shared / "study/squealpipe", shared / "study/done"
    with FileLock(shared / "study.lock"):
        if not done.exists():
            shutil.rmtree(original, ignore_errors=True)
            watching = {
                "PYTHONPATH": f"{WATCH}{os.pathsep}{original}",
                READ: str(shared / "read"),
            }
            run = run_snakemake(
                copy_checkout(original),
                "--configfile",
                "workflow/config/tiny.yaml",
                surroundings=watching,
            )
            assert run.returncode == 0, run.stderr[-6000:]
            done.touch()
    copy = own / "tiny_study"
    subprocess.run(["cp", "-a", original, copy], check=True)  # keeps the dates
    return TinyStudy(copy, copy / "results/tiny", shared / "read")


@pytest.fixture(scope="session")
def snakemake():
    """:func:`run_snakemake`, for tests in other folders."""
    return run_snakemake


@pytest.fixture(scope="session")
def new_checkout():
    """:func:`copy_checkout`, for fixtures of other folders that outlive one test."""
    return copy_checkout


@contextlib.contextmanager
def read_only_folder(folder):
    """A folder that nobody may write to; root is stopped by a read-only mount only."""
    if os.geteuid():
        folder.chmod(0o555)
        yield
        folder.chmod(0o755)
        return
    if subprocess.run(["mount", "--bind", folder, folder], check=False).returncode:
        pytest.skip("root can write everywhere, and nothing can be mounted here")
    try:
        subprocess.run(["mount", "-o", "remount,ro,bind", folder], check=True)
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


@pytest.fixture(scope="session")
def read_only():
    """:func:`read_only_folder`, for tests in other folders."""
    return read_only_folder
