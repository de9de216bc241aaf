"""``squealpipe init`` and ``squealpipe run``: a study of one's own, begun and computed."""

import os
import sys
import time
from pathlib import Path

from squealpipe.cli.arguments import Configs, Force, Switch, Whole
from squealpipe.cli.console import DONE, NOT_DONE, SESSION, say
from squealpipe.cli.output import check_output
from squealpipe.parameters import DEFAULTS, TABLE, Row
from squealpipe.text import duration

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
  k3: 7.0e+6 # of the contact; or measured, contact_law: {{table: contact.csv}}, of m and N
  mu: 0.4 # or measured, friction_law: {{table: friction.csv}}, of speed (m/s) and coefficient
  belt_speed: 2.0 # m/s
  preload: 2.0e-5 # m, so that the pad is pressed by k3 times it
  length1: 0.02 # m
  length2: 0.02
  damping1: 0.0 # N s/m, along the springs
  damping2: 0.0
"""


def init(
    file: Path = Path("mine.yaml"),
    /,
    *,
    results: str | None = None,
    own: Switch = False,
    force: Force = False,
) -> int:
    """Write a configuration to edit: the paper's parameters, and every other key as a comment.

    Example: `squealpipe init mine.yaml --own`

    Args:
        file: configuration to write (.yaml).
        results: folder of its results; results/NAME of the file by default.
        own: a short study of scenes of your own in SI units instead, without the paper.
    """
    from squealpipe.config.settings import PAPER, read_study
    from squealpipe.store.whole_files import whole_file

    check_output(file, force=force, kinds=(".yaml", ".yml"), option="FILE")
    folder = results or f"results/{file.stem}"
    if own:
        text = OWN.format(file=file, results=folder)
    else:
        text = overlay_text(
            PAPER.read_text(encoding="utf-8"), file=str(file), results=folder
        )
    with whole_file(file) as draft:
        draft.write_text(text, encoding="utf-8")
        read_study(PAPER, draft)
    say(f"wrote {file}; edit it, then: squealpipe run --config {file}")
    return DONE


def overlay_text(paper: str, *, file: str, results: str) -> str:
    """The paper's configuration as an overlay in which only the parameters are live."""
    live, lines = False, []
    for line in paper[paper.index("parameters:") :].splitlines():
        if line and not line.startswith((" ", "#")):
            live = line.startswith("parameters:")
        if not line and live:
            lines += [
                _commented(name, row) for name, row in TABLE.items() if row.extension
            ]
        lines.append(line if live or not line else f"# {line}")
    return HEAD.format(file=file, results=results) + "\n".join(lines) + "\n"


def _commented(name: str, row: Row) -> str:
    default = "null" if DEFAULTS[name] is None else DEFAULTS[name]
    units = "" if row.units == "1" else f", {row.units}"
    return f"  # {name}: {default} # {row.meaning}{units}"


def run(
    *, config: Configs = None, quick: Switch = False, cores: Whole | None = None
) -> int:
    """Compute a study, with Snakemake's account of the steps, and of what failed with its log.

    Stop it and run the same command again: it goes on where it was, rule by rule.

    Example: `squealpipe run --config mine.yaml --quick`

    Args:
        config: configuration laid over the paper's; repeatable.
        quick: coarse grids and short horizons, for a first look.
        cores: cores to use; all by default.
    """
    from squealpipe.execution.explain import snakemake_command
    from squealpipe.execution.supervised import (
        StoppedError,
        remove_stale_lock,
        run_to_its_end,
    )

    command, study = snakemake_command(config or [], quick=quick)
    for line in study.parameters.became():
        say(line)
    if removed := remove_stale_lock():
        say(removed)
    started = time.perf_counter()
    quiet = ["--quiet", "all"] if SESSION.quiet else ["--quiet", "host", "rules"]
    command += ["--cores", str(cores or "all"), *quiet]
    try:
        failed = run_to_its_end(command, {**os.environ, **_caches()})
    except StoppedError as stop:
        print(f"squealpipe: {stop}; run the same command again", file=sys.stderr)
        return 128 + stop.number
    if failed:
        print(
            f"squealpipe: the study in {study.results} is not complete", file=sys.stderr
        )
        return NOT_DONE
    say(
        f"done in {duration(time.perf_counter() - started)}: {study.results}/report/index.html"
    )
    return DONE


def _caches() -> dict[str, str]:
    """Where Snakemake and Matplotlib keep their caches if the home folder cannot be written."""
    if os.access(Path.home(), os.W_OK):
        return {}
    kept = str(Path(".snakemake/cache").resolve())
    return {"XDG_CACHE_HOME": kept, "MPLCONFIGDIR": f"{kept}/matplotlib", **os.environ}
