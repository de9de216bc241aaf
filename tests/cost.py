"""CPU time of the study or of the tests beside that of commit 5a1acd4c, on any machine.

    python tests/cost.py study FOLDER          of the jobs that have run in FOLDER
    python tests/cost.py tests COMMAND …       of a command and all that it starts

Times of machines differ, and so do those of one machine under load: each is divided by that of a
fixed loop, run right before. Exit code 1: more than ``costs.json`` allows.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from squealpipe.study.durations import job_costs

STORED = Path(__file__).with_name("costs.json")


def calibration() -> float:
    """CPU time of a fixed loop, s: half in Python, half in NumPy; the least of five."""
    return min(_loop() for _ in range(5))


def _loop() -> float:
    started = time.process_time()
    total = 0
    for i in range(5_300_000):
        total += i * i % 7
    values = np.linspace(0.0, 1.0, 20_000)
    for _ in range(1_830):
        values = np.sin(values) + 0.5 * values
    return time.process_time() - started


def study_time(folder: Path) -> float:
    """CPU time of all jobs that have run in a folder, s, without what compiling took.

    Raises:
        SystemExit: none has.
    """
    costs = job_costs(folder).values()
    if not costs:
        raise SystemExit(f"{folder}: no job has run here; run `snakemake` first")
    return sum(cost.cpu - cost.compiling for cost in costs)


def command_time(command: list[str]) -> float:
    """CPU time of a command and of all processes that it waits for, s."""
    before = os.times()
    subprocess.run(command, check=True)
    after = os.times()
    return (
        after.children_user
        + after.children_system
        - before.children_user
        - before.children_system
    )


def verdict(what: str, seconds: float, loop: float, stored: dict[str, Any]) -> bool:
    """Print the ratio to the stored commit, and return whether it is allowed."""
    ratio = seconds / loop / (stored[what] / stored["calibration"])
    limit = stored["limits"][what]
    print(
        f"{what}: {seconds:.0f} s of CPU with a loop of {loop:.2f} s, {ratio:.2f} of "
        f"{stored['commit']} ({stored[what]} s, {stored['calibration']} s); at most {limit}"
    )
    return ratio <= limit


def main(what: str, *arguments: str) -> int:
    """Measure and judge."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    loop = calibration()
    measures = {
        "study": lambda: study_time(Path(*arguments)),
        "tests": lambda: command_time(list(arguments)),
    }
    seconds = measures[what]()
    return 0 if verdict(what, seconds, loop, stored) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
