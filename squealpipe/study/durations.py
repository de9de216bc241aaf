"""Durations and CPU times of a study's jobs when they last ran, and of several together."""

import base64
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from squealpipe.store.whole_files import whole_file
from squealpipe.systems.processes import cpu_time

COSTS_FOLDER = Path(".snakemake/squealpipe/costs")
"""Folder of one record a job, beside Snakemake's own."""


class JobCost(NamedTuple):
    """Time that a rule took when it last ran, s.

    Attributes:
        cpu: of all its processes, from the start of Python to the last result.
        compiling: part of it in which code was compiled that the store did not have.
        clock: from Snakemake's records; None if it has none.
    """

    cpu: float
    compiling: float
    clock: float | None = None


def record_cost(rule: str, item: str, cpu: float | None = None) -> None:
    """Write down the CPU time of a job of Snakemake.

    Args:
        item: part of what is scattered, "i-of-n".
        cpu: s; None takes that of this process and of its children.
    """
    if not COSTS_FOLDER.parents[1].is_dir():
        return  # a script that was not started by Snakemake
    # a job that has not imported the compiler has compiled nothing
    compiled = sys.modules.get("squealpipe.systems.compiled")
    known: dict[str, Any] = {
        "rule": rule,
        "item": item,
        "cpu": cpu_time() if cpu is None else cpu,
        "compiling": compiled.compile_time() if compiled else 0.0,
    }
    COSTS_FOLDER.mkdir(parents=True, exist_ok=True)
    with whole_file(COSTS_FOLDER / f"{rule}.{item}.json") as temporary:
        temporary.write_text(json.dumps(known), encoding="utf-8")


def job_costs(directory: Path) -> dict[str, JobCost]:
    """Rule → what it took when it last ran; the parts of a scattered rule are added up."""
    records: dict[str, list[dict[str, Any]]] = {}
    files = (directory / COSTS_FOLDER).glob("*.json")
    for path in sorted(files, key=lambda each: each.stat().st_mtime):
        record = json.loads(path.read_text(encoding="utf-8"))
        records.setdefault(record["rule"], []).append(record)
    clock = job_times(directory)
    costs = {}
    for rule, parts in records.items():
        # parts of an earlier run may have been more, or fewer
        number = parts[-1]["item"].partition("-of-")[2]
        now = [part for part in parts if part["item"].endswith(f"-of-{number}")]
        cpu, compiling = (
            sum(part[name] for part in now) for name in ("cpu", "compiling")
        )
        costs[rule] = JobCost(cpu, compiling, clock.get(rule))
    return dict(sorted(costs.items(), key=lambda each: -each[1].cpu))


def job_times(directory: Path, results: str = "") -> dict[str, float]:
    """Rule → what it took when it last ran, s, from Snakemake's records.

    Args:
        results: folder of a study; the same rules may have made files of other studies here.
    """
    spans: dict[str, list[float]] = {}
    for path in (directory / ".snakemake/metadata").glob("*"):
        if not Path(_made(path.name)).is_relative_to(results):
            continue
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            start, end = float(record["starttime"]), float(record["endtime"])
        except (OSError, ValueError, KeyError, TypeError):
            continue  # a record that cannot be read means: duration unknown
        spans.setdefault(str(record["rule"]), []).append(end - start)
    return {rule: max(seconds) for rule, seconds in sorted(spans.items())}


def _made(name: str) -> str:
    """Return the output file that a record of Snakemake describes, encoded in the record's name."""
    try:
        return base64.urlsafe_b64decode(name).decode()
    except ValueError:
        return ""


def together(jobs: Sequence[float], cores: int) -> float:
    """Return the time that jobs take together, s: shared by all cores, but at least the longest."""
    return max([sum(jobs) / cores, *jobs])
