"""``squealpipe init`` and ``squealpipe run``: a study of one's own, begun and computed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TextIO

from squealpipe.cli.arguments import Configs, Switch, Whole
from squealpipe.cli.console import SESSION, say
from squealpipe.cli.exit_codes import DONE, NOT_DONE
from squealpipe.cli.output import check_output
from squealpipe.parameters import DEFAULTS, TABLE, Row
from squealpipe.progress import duration

QUICK = Path("workflow/config/quick.yaml")
HEAD = """\
# A study of your own, laid over the paper's: what stands here replaces what stands there.
# Edit the parameters; for other keys take away the "# " of the key and of its section.
#   squealpipe explain --config {file}    what will be computed, why, and how long it takes
#   squealpipe run --config {file}        compute it
results: {results}

"""
OWN = """\
# A study of scenes of your own: no paper, only what the mass does. Change the numbers, then
#   squealpipe run --config {file}
results: {results}
paper: false

scenes: # angles of the springs; start: displacements (m) and velocities (m/s), at rest if left out
  mine: {{alpha1: 30deg, alpha2: 140deg, start: {{vx: 0.001}}}}

parameters: # SI units
  mass: 0.5 # kg
  k1: 1.0e+7 # N/m
  k2: 1.0e+7
  k3: 7.0e+6 # of the contact
  mu: 0.4
  belt_speed: 2.0 # m/s
  preload: 2.0e-5 # m, so that the pad is pressed by k3 times it
  length1: 0.02 # m
  length2: 0.02
"""
PATIENCE = 30.0
"""Seconds in which a workflow that was interrupted may end its jobs and tidy up."""
GRACE = 5.0
"""Seconds after which jobs that did not heed the interrupt are killed, and then Snakemake."""


def init(
    file: Path = Path("mine.yaml"),
    /,
    *,
    results: str | None = None,
    own: Switch = False,
    force: Switch = False,
) -> int:
    """Write a configuration to edit: the paper's parameters, and every other key as a comment.

    Example: `squealpipe init mine.yaml --own`

    Args:
        file: configuration to write (.yaml).
        results: folder of its results; results/NAME of the file by default.
        own: a short study of scenes of your own in SI units instead, without the paper.
        force: overwrite a file that exists.
    """
    from squealpipe.config.settings import PAPER, read_study

    check_output(file, force=force, kinds=(".yaml", ".yml"), option="FILE")
    folder = results or f"results/{file.stem}"
    paper = (checkout() / PAPER).read_text(encoding="utf-8")
    text = (
        OWN.format(file=file, results=folder)
        if own
        else overlay_text(paper, file=str(file), results=folder)
    )
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    read_study(checkout() / PAPER, file)
    say(f"wrote {file}; edit it, then: squealpipe run --config {file}")
    return DONE


def overlay_text(paper: str, *, file: str, results: str) -> str:
    """The paper's configuration as an overlay in which only the parameters are live."""
    live, lines = False, []
    for line in paper[paper.index("parameters:") :].splitlines():
        if line and not line.startswith((" ", "#")):
            live = line.startswith("parameters:")
        if not line and live:
            lines += [_commented(name, row) for name, row in TABLE.items() if row.extension]
        lines.append(line if live or not line else f"# {line}")
    return HEAD.format(file=file, results=results) + "\n".join(lines) + "\n"


def _commented(name: str, row: Row) -> str:
    default = "null" if DEFAULTS[name] is None else DEFAULTS[name]
    return f"  # {name}: {default} # {row.meaning}" + (
        f", {row.units}" if row.units not in {"", "1"} else ""
    )


def checkout() -> Path:
    """The checkout with the workflow: this folder, or the one that the package runs from.

    Raises:
        FileNotFoundError: neither is one.
    """
    from squealpipe.config.settings import PAPER

    for folder in (Path(), Path(__file__).resolve().parents[2]):
        if (folder / "Snakefile").is_file() and (folder / PAPER).is_file():
            return folder
    raise FileNotFoundError(
        f"no Snakefile in {Path.cwd()}; run this in a checkout of the repository"
    )


def run(*, config: Configs = None, quick: Switch = False, cores: Whole | None = None) -> int:
    """Compute a study: one line for each rule when it is done, and what failed, with its log.

    Stop it and run the same command again: it goes on where it was.

    Example: `squealpipe run --config mine.yaml --quick`

    Args:
        config: configuration laid over the paper's; repeatable.
        quick: coarse grids and short horizons, for a first look.
        cores: cores to use; all by default.
    """
    from squealpipe.config.settings import PAPER, read_study
    from squealpipe.config.yaml_files import read_yaml

    root = checkout()
    overlays = [*([root / QUICK] if quick else []), *(config or [])]
    study = read_study(root / PAPER, *overlays)
    command = [sys.executable, "-m", "snakemake", "--nocolor", "--cores", str(cores or "all")]
    if root != Path():
        command += ["--snakefile", str(root / "Snakefile"), "--directory", str(Path.cwd())]
    overlays = [path for path in overlays if read_yaml(path)[0]]  # Snakemake takes no empty one
    if overlays:
        command += ["--configfile", *map(str, overlays)]
    log = Path(study.results) / "logs" / "run.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    SESSION.patience = PATIENCE
    SESSION.advice = lambda: "what is finished is kept; run the same command again to go on"
    started = time.perf_counter()
    with log.open("w", encoding="utf-8") as file:
        code, teller = _follow(command, file)
    for failure in teller.failures:
        print(f"failed: {failure}", file=sys.stderr)
    if code:
        print(f"squealpipe: the study is not complete; everything is in {log}", file=sys.stderr)
        return NOT_DONE
    taken = duration(time.perf_counter() - started)
    say(
        f"done in {taken}: {study.results}/report/index.html"
        if teller.rules
        else f"nothing to do: every result in {study.results} is up to date"
    )
    return DONE


def _caches() -> dict[str, str]:
    """Where Snakemake and Matplotlib keep their caches if the home folder cannot be written."""
    if os.access(Path.home(), os.W_OK):
        return {}
    kept = str(Path(".snakemake/cache").resolve())
    return {"XDG_CACHE_HOME": kept, "MPLCONFIGDIR": f"{kept}/matplotlib", **os.environ}


def _follow(command: list[str], log: TextIO) -> tuple[int, Teller]:
    """Run Snakemake, keep all that it says in the log, and say what matters."""
    teller = Teller()
    environment = {**os.environ, **_caches(), "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=environment,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None  # noqa: S101 (for the type checker)
        try:
            for line in process.stdout:
                log.write(line)
                log.flush()
                say(*teller.hear(line.rstrip("\n")))
            return process.wait(), teller
        except KeyboardInterrupt:
            os.killpg(process.pid, signal.SIGINT)
            if not _ended(process, log):  # a job does not heed it: Snakemake tidies up without it
                import psutil

                for job in psutil.Process(process.pid).children(recursive=True):
                    job.kill()
                if not _ended(process, log):
                    os.killpg(process.pid, signal.SIGKILL)
                    subprocess.run([*command, "--unlock"], capture_output=True, check=False)
            raise


def _ended(process: subprocess.Popen[str], log: TextIO) -> bool:
    """Whether Snakemake has come to its end within the time that it is given."""
    try:
        log.write(process.communicate(timeout=GRACE)[0])
    except subprocess.TimeoutExpired:
        return False
    return True


class Teller:
    """Reads Snakemake's account line by line and gives one line for each rule that is done."""

    def __init__(self) -> None:
        self.rules: Counter[str] = Counter()
        self.failures: list[str] = []
        self._begun: dict[str, float] = {}
        self._seconds: dict[str, float] = {}
        self._table = False
        self._failed = ""

    def hear(self, line: str) -> Iterable[str]:
        """Take in one line; what to say about it."""
        if re.match(r"job\s+count", line):
            self._table = True
        elif self._table and (match := re.match(r"(\w+)\s+(\d+)$", line)):
            if match[1] not in {"total", "all"}:
                self.rules[match[1]] = int(match[2])
        elif self._table and not line:
            self._table = False
        elif match := re.match(r"Job (\d+): ", line):
            self._begun.setdefault(match[1], time.perf_counter())
        elif match := re.match(r"Finished jobid: (\d+) \(Rule: (\w+)\)", line):
            yield from self._finished(*match.groups())
        elif match := re.match(r"Error in rule (\w+)", line):
            self._failed = match[1]
            self.failures.append(self._failed)
        elif self._failed and (match := re.match(r"\s+log: (.*?)(?: \(check.*)?$", line)):
            self.failures[-1] = f"{self._failed}, see {match[1]}"

    def _finished(self, job: str, rule: str) -> Iterable[Any]:
        now = time.perf_counter()
        self._seconds[rule] = self._seconds.get(rule, 0.0) + now - self._begun.get(job, now)
        self.rules[rule] -= 1
        if self.rules[rule] == 0 and rule != "all":
            left = sum(1 for count in self.rules.values() if count > 0)
            rest = f"{left} {'rule' if left == 1 else 'rules'} left"
            yield f"{rule:<32}{duration(self._seconds[rule]):>12}   {rest}"
