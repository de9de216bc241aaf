"""Description of the machine: the processor, and the packages of the solvers."""

import platform
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, packages_distributions, version
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
    known, installed = {}, packages_distributions()  # looks through all packages, 0.2 s
    for name in solvers:
        module, needs, _ = SOLVERS.get(name, ("", "", {}))
        ours = ["squealpipe"] if module == "squealpipe" else []
        for package in (ours or installed.get(needs, []))[:1]:
            try:
                known[name] = f"{package} {version(package)}"
            except PackageNotFoundError:
                continue
    return known
