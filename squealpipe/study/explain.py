"""Forecast of the next run of `snakemake`: rules, their reasons, changed figures, duration.

Snakemake gives its summary of every file and its records of earlier runs; the workflow gives what
each file should be made from. Nothing is read from text that Snakemake writes for people.
"""

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Container, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from squealpipe.store.keys import misfits
from squealpipe.store.rerun.key import PLAN_VARIABLE, files_named_in
from squealpipe.store.rerun.sources import PACKAGE, WORKFLOW
from squealpipe.store.sealed import attributes
from squealpipe.store.whole_files import StoreError
from squealpipe.store.yaml_files import flat, read_yaml
from squealpipe.study.configuration.settings import PAPER, Study, read_study
from squealpipe.study.durations import job_times, together
from squealpipe.systems.inputs.words import duration

FIGURE = re.compile(r"figures/([\w-]+)\.\w+$")


class WorkflowError(RuntimeError):
    """Snakemake could not plan; the message is its own."""


@dataclass(frozen=True, kw_only=True)
class PlannedJob:
    """A rule that would run.

    Attributes:
        reasons: why, in words, for instance ``parameters.mu: 0.3 → 0.4``.
        follows: rules whose new results it reads.
        seconds: duration of its last run, or None if it never ran.
        changing: its figures that change, beside which the rule draws others. None: all.
    """

    rule: str
    outputs: list[str]
    reasons: list[str]
    follows: list[str]
    seconds: float | None = None
    changing: list[str] | None = None

    @property
    def figures(self) -> list[str]:
        """Figures that the rule draws and that change."""
        drawn = (FIGURE.search(path) for path in self.outputs)
        names = sorted({match[1] for match in drawn if match})
        return names if self.changing is None else self.changing

    def why(self) -> str:
        """Reasons as one phrase."""
        followed = [f"follows {', '.join(self.follows)}"] if self.follows else []
        return "; ".join([*self.reasons, *followed]) or "asked for"


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """The plan.

    Attributes:
        keys: file of the study → the key that it must state.
        became: what inputs that stand for parameters became, in words.
    """

    jobs: list[PlannedJob] = field(default_factory=list)
    keys: dict[str, str] = field(default_factory=dict)
    became: list[str] = field(default_factory=list)
    cores: int = field(default_factory=lambda: os.cpu_count() or 1)

    @property
    def figures(self) -> list[str]:
        """Figures that would be drawn again."""
        return sorted({name for job in self.jobs for name in job.figures})

    @property
    def seconds(self) -> float:
        """Estimated duration, by :func:`together`, without jobs of unknown length."""
        return together([job.seconds or 0.0 for job in self.jobs], self.cores)

    def estimate(self) -> str:
        """Return for instance ``about 41 s on 2 cores, from recorded times``."""
        unknown = [job.rule for job in self.jobs if job.seconds is None]
        if len(unknown) == len(self.jobs):
            return "no time estimate: none of these rules has run here yet"
        rest = f"; not counted, never run: {', '.join(unknown)}" if unknown else ""
        return f"about {duration(self.seconds)} on {self.cores} cores, from recorded times{rest}"

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        jobs = [asdict(job) for job in self.jobs]
        return {
            "jobs": jobs,
            "figures": self.figures,
            "seconds": self.seconds,
            "became": self.became,
        }


def explain(
    configs: Iterable[str | os.PathLike[str]] = (),
    *,
    quick: bool = False,
    directory: str | os.PathLike[str] = ".",
) -> Explanation:
    """Ask Snakemake what it would do and put it in terms of keys and sources."""
    there = Path(directory)
    command, study = snakemake_command(configs, quick=quick, directory=there)
    with tempfile.NamedTemporaryFile("r", suffix=".json", encoding="utf-8") as plan:
        done = subprocess.run(
            [*command, "--summary"],
            cwd=there,
            env={**os.environ, PLAN_VARIABLE: plan.name},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise WorkflowError(
                f"snakemake could not plan:\n{(done.stdout + done.stderr).strip()}"
            )
        planned: dict[str, dict[str, Any]] = json.load(plan)
    rows = [line.split("\t") for line in done.stdout.splitlines()[1:]]
    # rules that the report of a study of one's own does not need are left out
    made = {row[0]: planned[row[0]] for row in rows if row[0] in planned}
    pending = {row[0] for row in rows if row[-1] == "update pending"}
    kept = {path: made[path]["key"] for path in made if path not in pending}
    pending |= {line.partition(": ")[0] for line in misfits(kept, there)}
    times = job_times(there)
    jobs = []
    for rule in dict.fromkeys(made[path]["rule"] for path in made if path in pending):
        outputs = [
            path for path in made if path in pending and made[path]["rule"] == rule
        ]
        first = made[outputs[0]]
        follows = sorted(
            {made[path]["rule"] for path in first["inputs"] if path in pending}
        )
        missing = [path for path in outputs if not (there / path).exists()]
        changes = [what for path in outputs for what in _changes(there / path, first)]
        reasons = (
            [f"missing: {_some(missing)}"] if missing else list(dict.fromkeys(changes))
        )
        if not reasons and not follows:
            reasons = [_changed_content(there / outputs[0], first)]
        seconds = times.get(rule)
        jobs.append(
            PlannedJob(
                rule=rule,
                outputs=outputs,
                reasons=reasons,
                follows=follows,
                seconds=seconds,
                changing=_changing(
                    there, {path: made[path] for path in outputs}, pending
                ),
            )
        )
    return Explanation(
        jobs=jobs,
        keys={path: made[path]["key"] for path in made},
        became=study.parameters.became(),
    )


def snakemake_command(
    configs: Iterable[str | os.PathLike[str]] = (),
    *,
    quick: bool = False,
    directory: str | os.PathLike[str] = ".",
) -> tuple[list[str], Study]:
    """Snakemake's command for a study, and the study, which is validated before anything runs.

    A quick study goes beside the full one: ``results/mine-quick`` beside ``results/mine``.
    """
    refuse_other_package(Path(directory))
    if find_spec("snakemake") is None:
        raise WorkflowError(
            "a study needs Snakemake; pip install 'squealpipe[study]', or '.[study]' in a checkout"
        )
    own_files = [Path(path).absolute() for path in configs]
    full = read_study(PAPER, *own_files)
    paths = [*([PAPER.with_name("quick.yaml")] if quick else []), *own_files]
    changes = {}
    if quick:
        beside = full.results == Study().results
        changes["results"] = f"{full.results}{'/quick' if beside else '-quick'}"
    study = read_study(PAPER, *paths, changes=changes)
    command = [sys.executable, "-m", "snakemake", "--nocolor"]
    command += ["--snakefile", str(WORKFLOW / "Snakefile")]
    command += ["--directory", str(Path(directory).absolute())]
    filled = [str(path) for path in paths if read_yaml(path)]
    if filled:  # Snakemake takes no empty file
        command += ["--configfile", *filled]
    if changes:
        command += ["--config", *(f"{key}={value}" for key, value in changes.items())]
    return command, study


def refuse_other_package(directory: Path) -> None:
    """Raise if a folder is a checkout with a package of its own, which Snakemake would import.

    Its code would be compared with that of another checkout, and every rule would seem changed.
    """
    own = directory.absolute() / PACKAGE.name
    if not ((own / "__init__.py").is_file() and (own.parent / "Snakefile").is_file()):
        return
    if not (own.samefile(PACKAGE) or _same_code(own)):
        raise WorkflowError(
            f"the package was imported from {PACKAGE}, but this folder is a checkout with one of "
            f"its own, {own}; run .venv/bin/squealpipe of this folder (make env builds it), or "
            f"write PYTHONPATH={shlex.quote(str(own.parent))} before the command"
        )


def _same_code(package: Path) -> bool:
    """Tell whether a package has the code that is imported, as if installed from this folder."""
    return all(
        (there := PACKAGE / file.relative_to(package)).is_file()
        and there.read_bytes() == file.read_bytes()
        for file in package.rglob("*.py")
    )


def _changes(path: Path, made: Mapping[str, Any]) -> list[str]:
    """``key: old → new`` for a dataset of another configuration."""
    if path.suffix != ".nc":
        return []
    try:
        old = flat(json.loads(attributes(path).get("config", "{}")))
    except (StoreError, FileNotFoundError):
        return [f"{path.name} is damaged"]
    new = flat(made["settings"])
    return [
        f"{key}: {old.get(key, 'absent')} → {new[key]}"
        for key in new
        if old.get(key) != new[key]
    ]


def _changing(
    there: Path, outputs: Mapping[str, Mapping[str, Any]], pending: Container[str]
) -> list[str] | None:
    """Return the figures that change, among all that a rule draws for one topic.

    A figure changes if it is missing, if a dataset that it reads is pending, or if a module that it
    imports is younger. None if the rule draws no figures, or none of these is why it runs.
    """
    changing = set()
    for path, made in outputs.items():
        if not (match := FIGURE.search(path)):
            return None
        file = there / path
        if (
            not file.exists()
            or any(each in pending for each in made["reads"])
            or any(
                Path(source).stat().st_mtime > file.stat().st_mtime
                for source in made["imports"]
            )
        ):
            changing.add(match[1])
    return sorted(changing) or None


def _changed_content(output: Path, made: Mapping[str, Any]) -> str:
    """Say which files are younger than an output: those that its settings name, or modules."""
    written = output.stat().st_mtime

    def newer(paths: Iterable[str]) -> list[str]:
        return [path for path in paths if Path(path).stat().st_mtime > written]

    if edited := newer(dict.fromkeys(files_named_in(made["settings"]))):
        return f"changed: {_some(edited)}"
    modules = [Path(path).name for path in newer(made["sources"])]
    return f"code changed{f', of {_some(modules)}' if modules else ''}"


def _some(files: list[str]) -> str:
    most_names = 4
    more = len(files) - most_names
    return ", ".join(files[:most_names]) + (f" and {more} more" if more > 0 else "")
