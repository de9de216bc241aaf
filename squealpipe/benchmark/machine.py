"""Description of the machine: the processor, and the packages of the solvers."""

import platform
from collections.abc import Iterable
from functools import cache
from importlib.metadata import (
    PackageNotFoundError,
    distribution,
    packages_distributions,
)
from pathlib import Path

from squealpipe.benchmark.adapters import SOLVERS


def processor() -> str:
    """Return the processor's name for itself, or the machine's kind where it has none."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2] for line in lines if line.startswith("model name")]
    named = names[0].strip() if names else platform.processor()
    return named or platform.machine()


def versions(solvers: Iterable[str]) -> dict[str, str]:
    """Solver → package and version, of those that are shipped and whose package has one."""
    known = {}
    for name in solvers:
        module, needs, _ = SOLVERS.get(name, ("", "", {}))
        package = _package("squealpipe" if module == "squealpipe" else needs)
        if package:
            known[name] = package
    return known


@cache
def _package(module: str) -> str:
    """Return package and version that a module comes from, empty where it is not installed."""
    try:
        package = distribution(module)
    except (PackageNotFoundError, ValueError):  # has another name, or none
        # looks through all packages, 0.2 s
        names = packages_distributions().get(module, [])
        if not names:
            return ""
        package = distribution(names[0])
    return f"{package.name} {package.version}"
