"""CPU time of the study or of the tests beside that of commit 5a1acd4c, on any machine.

    python -m tests.cost FOLDER         of the jobs of the paper's study that ran in FOLDER
    python -m pytest … -p tests.cost    of the tests, told before pytest's closing line

Times of machines differ, and so do those of one machine under load: each is divided by that of a
fixed loop, run right before or after. What compiling took does not count. A study that costs more
than ``costs.json`` allows is a failure, exit code 1, and so is one of which jobs are missing. Costs
of the tests are told only: whether a change is right must not depend on what else the machine does.
"""

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squealpipe.study.durations import job_costs

STORED = Path(__file__).with_name("costs.json")
TIMES = "cpu_times"
"""Key of what a process of the tests tells of its CPU time, without compiling, s."""


def calibration() -> float:
    """CPU time of a fixed loop, s: half in Python, half in NumPy; of its tenths the least."""
    return 10 * min(_tenth() for _ in range(10))


def _tenth() -> float:
    started = time.process_time()
    total = 0
    for i in range(530_000):
        total += i * i % 7
    values = np.linspace(0.0, 1.0, 20_000)
    for _ in range(183):
        values = np.sin(values) + 0.5 * values
    return time.process_time() - started


def study_time(folder: Path, needed: list[str]) -> float:
    """CPU time of jobs that have run in a folder, s, without what compiling took.

    Args:
        needed: rules whose jobs count, with what their jobs share. Each has to have run there; what
            another study has left there does not count.

    Raises:
        SystemExit: one has not.
    """
    costs = job_costs(folder)
    if missing := [rule for rule in needed if rule not in costs]:
        raise SystemExit(
            f"{folder}: {', '.join(missing)} did not run here; run `snakemake` first"
        )
    shared = {"imports"} & costs.keys()  # none where jobs are not forked
    return sum(costs[rule].cpu - costs[rule].compiling for rule in {*needed} | shared)


def verdict(
    what: str, seconds: float, loop: float, stored: dict[str, Any]
) -> tuple[bool, str]:
    """Return whether the ratio to the stored commit is allowed, and a line that says so."""
    ratio = seconds / loop / (stored[what] / stored["calibration"])
    limit = stored["limits"][what]
    return ratio <= limit, (
        f"{what}: {seconds:.3g} s of CPU with a loop of {loop:.2f} s, {ratio:.2f} of "
        f"{stored['commit']} ({stored[what]} s, {stored['calibration']} s); at most {limit}"
    )


def stored_costs() -> dict[str, Any]:
    """Return the times of the stored commit, and the limits."""
    return dict(json.loads(STORED.read_text(encoding="utf-8")))


def main(folder: str) -> int:
    """Judge the study in a folder."""
    stored = stored_costs()
    seconds = study_time(Path(folder), stored["rules"])
    is_allowed, line = verdict("study", seconds, calibration(), stored)
    print(line)
    return 0 if is_allowed else 1


def own_time() -> float:
    """CPU time of this process and of all that it has waited for, s, without compiling."""
    times = os.times()
    compiled = sys.modules.get("squealpipe.systems.compiled")
    return sum(times[:4]) - (compiled.compile_time() if compiled else 0.0)


class _Tier:
    """CPU times of the processes of the tests that have ended, s."""

    def __init__(self) -> None:
        self.times: list[float] = []


_tier = _Tier()


def pytest_testnodedown(node: Any) -> None:
    """Note the time of a process of the tests that has ended."""
    # one that crashed, which fails the tests, has told nothing
    _tier.times.append(getattr(node, "workeroutput", {}).get(TIMES, 0.0))


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session: Any) -> None:
    """Have the process tell its time, or add up those of all."""
    output = getattr(session.config, "workeroutput", None)
    if output is not None:
        output[TIMES] = own_time()
        return
    seconds = own_time() + sum(_tier.times)
    _, session.config.cost_line = verdict(
        "tests", seconds, calibration(), stored_costs()
    )


def pytest_terminal_summary(terminalreporter: Any, config: Any) -> None:
    """Say what the tests cost."""
    terminalreporter.write_line(config.cost_line)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
