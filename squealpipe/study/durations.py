"""Durations of a study's jobs when they last ran, and of several together."""

import json
from collections.abc import Sequence
from pathlib import Path


def job_times(directory: Path) -> dict[str, float]:
    """Rule → what it took when it last ran, s, from Snakemake's records."""
    spans: dict[str, list[float]] = {}
    for path in (directory / ".snakemake/metadata").glob("*"):
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            start, end = float(record["starttime"]), float(record["endtime"])
        except (OSError, ValueError, KeyError, TypeError):
            continue  # a record that cannot be read means: duration unknown
        spans.setdefault(str(record["rule"]), []).append(end - start)
    return {rule: max(seconds) for rule, seconds in sorted(spans.items())}


def together(jobs: Sequence[float], cores: int) -> float:
    """Return the time that jobs take together, s: shared by all cores, but at least the longest."""
    return max([sum(jobs) / cores, *jobs])
