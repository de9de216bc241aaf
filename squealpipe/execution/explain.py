"""What `snakemake` would do now: which rules run, why, which figures change, how long it takes.

Snakemake is asked for a dry run in a process of its own; its reasons are put in terms of
configuration keys and source files, and durations come from its records of earlier runs.
"""

from __future__ import annotations

import ast
import base64
import binascii
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squealpipe.config.settings import PAPER, read_study
from squealpipe.config.yaml_files import flat, read_yaml
from squealpipe.progress import duration

FIGURE = re.compile(r"figures/([\w-]+)\.\w+$")
STALE = re.compile(r"^stale (\S+): (.*)$", flags=re.MULTILINE)
MOST_REASONS = 4
"""Reasons of one job that are printed; JSON has all."""


SAME_JOB = 0.05
"""Files of a rule that were begun and ended within so many seconds come from one job."""


class WorkflowError(RuntimeError):
    """Snakemake could not plan; the message is its own."""


@dataclass(frozen=True, kw_only=True)
class Record:
    """What Snakemake noted about a file that it made."""

    rule: str
    seconds: float
    params: str
    ended: float = field(default=0.0, compare=False)
    """When its job ended, s since 1970; for the files of one job the same but for milliseconds."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """One job that would run.

    Attributes:
        rule: its rule.
        outputs: files that it would make.
        reasons: why, in words, for instance ``parameters.mu: 0.3 → 0.4``.
        follows: rules whose new results it reads.
        threads: cores that it takes.
        seconds: duration of its last run, or None if it never ran.
    """

    rule: str
    outputs: tuple[str, ...]
    reasons: tuple[str, ...]
    follows: tuple[str, ...]
    threads: int = 1
    seconds: float | None = None


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """The plan.

    Attributes:
        jobs: in the order of Snakemake's plan.
        cores: used for the estimate.
    """

    jobs: tuple[Job, ...] = ()
    cores: int = field(default_factory=lambda: os.cpu_count() or 1)

    @property
    def figures(self) -> list[str]:
        """Figures that would be drawn again."""
        found = (FIGURE.search(path) for job in self.jobs for path in job.outputs)
        return sorted({match[1] for match in found if match})

    @property
    def seconds(self) -> float:
        """Estimated duration: the work shared by all cores, or the longest chain of jobs.

        Jobs that never ran count nothing.
        """
        work = sum((job.seconds or 0) * min(job.threads, self.cores) for job in self.jobs)
        finish: dict[str, float] = {}
        for job in self.jobs:
            start = max((finish.get(rule, 0.0) for rule in job.follows), default=0.0)
            finish[job.rule] = max(start + (job.seconds or 0), finish.get(job.rule, 0.0))
        return max(work / self.cores, *finish.values(), 0.0)

    @property
    def unknown(self) -> list[str]:
        """Rules without a record, which the estimate leaves out."""
        return sorted({job.rule for job in self.jobs if job.seconds is None})

    def lines(self) -> list[str]:
        """The plan as plain text."""
        if not self.jobs:
            return ["nothing to do: every result is up to date"]
        text = []
        for job in self.jobs:
            time = "never run" if job.seconds is None else duration(job.seconds)
            text.append(f"{job.rule} ({time}): {'; '.join(why(job))}")
        text.append(f"figures that change: {', '.join(self.figures) or 'none'}")
        text.append(self.estimate())
        return text

    def estimate(self) -> str:
        """For instance ``about 41 s on 2 cores, from recorded times``."""
        if self.jobs and all(job.seconds is None for job in self.jobs):
            return "how long it takes is not known: none of these rules has run here"
        rest = f"; not counted, never run: {', '.join(self.unknown)}" if self.unknown else ""
        return f"about {duration(self.seconds)} on {self.cores} cores, from recorded times{rest}"

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return {
            "jobs": [
                {
                    "rule": job.rule,
                    "outputs": list(job.outputs),
                    "reasons": list(job.reasons),
                    "follows": list(job.follows),
                    "seconds": job.seconds,
                }
                for job in self.jobs
            ],
            "figures": self.figures,
            "seconds": self.seconds,
            "never_run": self.unknown,
        }


def why(job: Job) -> list[str]:
    """Reasons of a job as phrases, the first few of many."""
    more = len(job.reasons) - MOST_REASONS
    told = [*job.reasons[:MOST_REASONS], *([f"and {more} more"] if more > 0 else [])]
    followed = [f"follows {', '.join(job.follows)}"] if job.follows else []
    return [*told, *followed] or ["asked for"]


def explain(
    configs: Iterable[str | os.PathLike[str]] = (),
    *,
    root: str | os.PathLike[str] = ".",
    directory: str | os.PathLike[str] | None = None,
) -> Explanation:
    """Ask Snakemake what it would do and put it in terms of keys and sources.

    Args:
        configs: YAML files laid over the paper's configuration, as with ``--configfile``.
        root: the checkout.
        directory: where the study runs; the checkout by default.

    Raises:
        FileNotFoundError: no Snakefile, or a configuration that is missing.
        ConfigError: mistakes in the configuration.
        WorkflowError: Snakemake could not plan.
    """
    base = Path(root)
    if not (base / "Snakefile").is_file():
        raise FileNotFoundError(f"no Snakefile in {base.resolve()}; run this in the checkout")
    overlays = [str(Path(path).absolute()) for path in configs]
    read_study(base / PAPER, *overlays)
    overlays = [path for path in overlays if read_yaml(Path(path))[0]]  # Snakemake takes no empty
    command = [sys.executable, "-m", "snakemake", "--dry-run", "--nocolor"]
    there = base if directory is None else Path(directory)
    command += ["--snakefile", str((base / "Snakefile").absolute())]
    if overlays:
        command += ["--configfile", *overlays]
    run = subprocess.run(command, cwd=there, capture_output=True, text=True, check=False)
    if run.returncode:
        raise WorkflowError(f"snakemake could not plan:\n{(run.stdout + run.stderr).strip()}")
    return Explanation(jobs=tuple(read_plan(run.stdout, records(there), told_stale(run.stderr))))


def told_stale(text: str) -> dict[str, list[str]]:
    """File → why it is out of date, from the lines that the Snakefile prints about such files."""
    return {match[1]: match[2].split("; ") for match in STALE.finditer(text)}


def read_plan(
    text: str, known: Mapping[str, Record], stale: Mapping[str, list[str]] | None = None
) -> list[Job]:
    """Jobs of a dry run's output.

    Args:
        text: standard output of ``snakemake --dry-run``.
        known: file → record of the run that made it.
        stale: file → why it is out of date, where Snakemake itself does not see it.
    """
    blocks = re.split(r"^(?:local)?(?:rule|checkpoint) (\w+):$", text, flags=re.MULTILINE)[1:]
    planned = {}
    for rule, block in zip(blocks[::2], blocks[1::2], strict=True):
        entries = dict(re.findall(r"^    (\w+): (.*)$", block, flags=re.MULTILINE))
        if "output" in entries:
            outputs = tuple(entries["output"].split(", "))
            planned[outputs] = (rule, entries)
    maker = {path: rule for outputs, (rule, _) in planned.items() for path in outputs}
    slowest: dict[str, float] = {}
    for record in known.values():
        slowest[record.rule] = max(record.seconds, slowest.get(record.rule, 0.0))
    jobs = []
    for outputs, (rule, entries) in planned.items():
        own = known.get(outputs[0])
        reasons, updated = _reasons(entries.get("reason", ""))
        own_reasons = [phrase for path in outputs for phrase in (stale or {}).get(path, [])]
        reasons = list(dict.fromkeys(own_reasons)) or reasons
        jobs.append(
            Job(
                rule=rule,
                outputs=outputs,
                reasons=tuple(reasons),
                follows=tuple(sorted({maker[path] for path in updated if path in maker})),
                threads=int(entries.get("threads", 1)),
                seconds=own.seconds if own else slowest.get(rule),
            )
        )
    return jobs


def records(base: Path) -> dict[str, Record]:
    """File → record, from Snakemake's metadata folder."""
    found = {}
    for path in (base / ".snakemake/metadata").glob("*"):
        try:
            name = base64.b64decode(path.name, validate=True).decode()
            entry = json.loads(path.read_text(encoding="utf-8"))
            found[name] = Record(
                rule=str(entry["rule"]),
                seconds=float(entry["endtime"]) - float(entry["starttime"]),
                params=str(entry["params"]),
                ended=float(entry["endtime"]),
            )
        except (OSError, ValueError, KeyError, TypeError, binascii.Error):
            continue  # a record that cannot be read means: duration unknown
    return found


def job_times(known: Mapping[str, Record]) -> dict[str, list[float]]:
    """Rule → what each of its jobs took, s; files that one job made together count once."""
    times: dict[str, list[float]] = {}
    latest: dict[str, Record] = {}
    for record in sorted(known.values(), key=lambda record: (record.rule, record.ended)):
        last = latest.get(record.rule)
        latest[record.rule] = record
        together = last is not None and (
            abs(record.ended - last.ended) < SAME_JOB
            and abs(record.seconds - last.seconds) < SAME_JOB
        )
        if not together:
            times.setdefault(record.rule, []).append(record.seconds)
    return times


def _reasons(text: str) -> tuple[list[str], list[str]]:
    """Snakemake's reason as phrases, and the files that other jobs will have updated."""
    told: list[str] = []
    updated: list[str] = []
    for phrase in re.split(r"; (?=[A-Z])", text):
        head, _, rest = phrase.partition(": ")
        files = [name for name in rest.split(", ") if name]
        if head == "Input files updated by another job":
            updated = files
        elif head == "Missing output files":
            told.append(f"missing: {_some(files)}")
        elif head == "Incomplete output files":
            told.append(f"interrupted: {_some(files)}")
        elif head == "Updated input files" and not told:  # of a missing file nothing is older
            told.extend(f"{name} changed" for name in sorted(files))
        elif head == "Params have changed since last execution":
            told.extend(changed_keys(rest))
        elif phrase and head != "Updated input files":
            told.append(phrase[0].lower() + phrase[1:])
    return told, updated


def _some(files: list[str]) -> str:
    more = f" and {len(files) - 2} more" if len(files) > 2 else ""
    return ", ".join(sorted(files)[:2]) + more


def changed_keys(text: str) -> list[str]:
    """``key: old → new`` for each key, from Snakemake's account of changed parameters."""
    match = re.search(r"before: (.*) now: (.*)$", text.strip(), flags=re.DOTALL)
    before, now = (_literals(side) for side in match.groups()) if match else ({}, {})
    changes = [
        f"{key}: {before.get(key, 'absent')} → {now.get(key, 'absent')}"
        for key in sorted(set(before) | set(now))
        if before.get(key) != now.get(key)
    ]
    return changes or ["parameters of the rule changed"]


def _literals(text: str) -> dict[str, Any]:
    """Dotted key → value of the dictionaries in a comma-separated list of Python literals."""
    try:
        values = ast.literal_eval(f"[{text}]")
    except (ValueError, SyntaxError):
        return {}
    found: dict[str, Any] = {}
    for value in values:
        if isinstance(value, dict):
            found.update(flat(value))
    return found
