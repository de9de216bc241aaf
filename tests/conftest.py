"""Shared fixtures: a copy of the checkout, and one run of the quick study for all tests."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NOT_COPIED = shutil.ignore_patterns(
    ".git", ".venv*", ".snakemake", "__pycache__", ".*_cache", ".hypothesis", "*.egg-info"
)


def copy_checkout(target: Path) -> Path:
    """A copy of the project without its environment, history and results."""
    shutil.copytree(ROOT, target, ignore=NOT_COPIED, symlinks=True)
    shutil.rmtree(target / "results")
    (target / "results").mkdir()
    return target


def run_snakemake(
    directory: Path, *arguments: str, timeout: float = 500
) -> subprocess.CompletedProcess[str]:
    """Run snakemake in a copy, with the package of that copy."""
    return subprocess.run(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=directory,
        env={**os.environ, "PYTHONPATH": str(directory)},
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


@pytest.hookimpl(tryfirst=True)  # before xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """One process for all that reads the quick study, so that it is run once; else one a file."""
    for item in items:
        shared = "quick_study" in getattr(item, "fixturenames", ())
        item.add_marker(pytest.mark.xdist_group("study" if shared else str(item.path)))


@dataclass(frozen=True)
class QuickStudy:
    """A finished quick study: its checkout, its results, and what snakemake printed."""

    checkout: Path
    results: Path
    log: str
    seconds: float


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A fresh copy of the project."""
    return copy_checkout(tmp_path / "squealpipe")


@pytest.fixture(scope="session")
def quick_study(tmp_path_factory: pytest.TempPathFactory) -> QuickStudy:
    """The quick study, run once a session in a copy of the project."""
    import time

    directory = copy_checkout(tmp_path_factory.mktemp("study") / "squealpipe")
    started = time.perf_counter()
    run = run_snakemake(directory, "--configfile", "workflow/config/quick.yaml")
    assert run.returncode == 0, run.stderr[-6000:]
    return QuickStudy(
        directory, directory / "results/quick", run.stderr, time.perf_counter() - started
    )


@pytest.fixture(scope="session")
def snakemake() -> Callable[..., subprocess.CompletedProcess[str]]:
    """:func:`run_snakemake`, for tests in other folders."""
    return run_snakemake


@pytest.fixture(scope="session")
def new_checkout() -> Callable[[Path], Path]:
    """:func:`copy_checkout`, for fixtures of other folders that outlive one test."""
    return copy_checkout


@contextlib.contextmanager
def read_only_folder(folder: Path) -> Iterator[None]:
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
def read_only() -> Callable[[Path], contextlib.AbstractContextManager[None]]:
    """:func:`read_only_folder`, for tests in other folders."""
    return read_only_folder
