"""``squealpipe init`` and ``squealpipe run``: a study of one's own, begun and computed."""

import os
import re
import shlex
import sys
import time
from collections.abc import Iterable
from pathlib import Path

from squealpipe.cli.arguments import Configs, Force, Switch, Whole
from squealpipe.cli.console import ExitCodes, current_session, say
from squealpipe.cli.output import check_output
from squealpipe.parameters import DEFAULTS, TABLE, Row
from squealpipe.systems.inputs.words import duration

HEAD = """\
# A study of your own, laid over the paper's: what stands here replaces what stands there.
# Edit the parameters; for other keys take away the "# " of the key and of its section.
#   squealpipe explain --config {file}    what will be computed, why, and how long it takes
#   squealpipe run --config {file}        compute it
results: {results}

"""
OWN_STUDY = """\
# A brake of your own: does it squeal or hammer, at how many hertz, why, and what stops it?
# Change the numbers, then
#   squealpipe assess 22deg 46deg --config {file}   the answer for one pair of angles, in seconds
#   squealpipe run --config {file}                  the report of the scenes below, in minutes
results: {results}
paper: false

# Angles of the springs that hold the pad, counted from the belt's line upwards:
# alpha1 from +x, the way the belt runs, alpha2 from -x.
#
#    fixed end of spring 2  o               o  fixed end of spring 1
#                            \\            /
#                      alpha2 \\          / alpha1
#               -x . . . . . . . (pad) . . . . . . . +x
#              ======================================  belt, runs to the right -->
scenes:
  mine: {{alpha1: 22deg, alpha2: 46deg}}

parameters: # SI units: a pad of 0.45 kg, pressed by k3 * preload = 4 kN
  mass: 0.45 # kg
  k1: 1.0e+7 # N/m, of spring 1
  k2: 1.0e+7
  k3: 7.0e+6 # of the contact; or measured, contact_law: {{table: contact.csv}}, of m and N
  preload: 5.714e-4 # m, compression of the contact at rest
  friction_law: exponential # or measured, friction_law: {{table: friction.csv}}, of m/s and mu
  mu: 0.37 # friction at high sliding speed
  mu_static: 0.55 # and at none
  friction_speed: 1.7 # m/s, over which it falls
  belt_speed: 2.0 # m/s
  length1: 0.1 # m, of spring 1
  length2: 0.1
  damping1: 42.4 # N s/m, along spring 1: 1 % of critical, 2 * 0.01 * sqrt(k1 * mass)
  damping2: 42.4
"""


def init(
    file: Path = Path("mine.yaml"),
    /,
    *,
    results: str | None = None,
    own: Switch = False,
    structure: Switch = False,
    disc: Switch = False,
    force: Force = False,
) -> int:
    """Write a configuration to edit: the paper's parameters, and every other key as a comment.

    Example: `squealpipe init mine.yaml --own`

    Args:
        file: configuration to write (.yaml).
        results: folder of its results; results/NAME of the file by default.
        own: a short study of scenes of your own in SI units instead, without the paper.
        structure: a study of a structure with contacts instead, with an example of its files in a
            folder NAME beside it.
        disc: likewise, with a disc brake as the example: its deck, and its matrices as CalculiX
            writes them. Implies --structure.
    """
    from squealpipe.cli.structure_example import (
        DISC_STUDY,
        EXAMPLE_FILES,
        STUDY,
        disc_files,
    )
    from squealpipe.store.whole_files import whole_file
    from squealpipe.study.configuration.settings import PAPER, read_study

    check_output(file, force=force, kinds=(".yaml", ".yml"), option="FILE")
    # a disc brake is a structure: both together ask for no more than --disc
    asked = {"--own": own, "--structure": structure and not disc, "--disc": disc}
    if sum(asked.values()) > 1:
        names = " and ".join(name for name, is_asked in asked.items() if is_asked)
        raise ValueError(f"{names} are different studies; choose one")
    # other characters do not belong in the name of a folder
    stem = re.sub(r"[^A-Za-z0-9._-]+", "_", file.stem)
    folder = results or f"results/{stem}"
    if structure or disc:
        parts = file.parent / stem
        if parts.exists() and not force:
            raise ValueError(
                f"{parts} exists; add --force to write the example's files into it, or change FILE"
            )
        for name, content in (disc_files() if disc else EXAMPLE_FILES).items():
            with whole_file(parts / name) as draft:
                draft.write_bytes(
                    content if isinstance(content, bytes) else content.encode()
                )
        text = (DISC_STUDY if disc else STUDY).format(
            file=shlex.quote(str(file)),
            results=folder,
            folder=stem,
            matrices=shlex.quote(str(parts / "structure.yaml")),
        )
    elif own:
        text = OWN_STUDY.format(file=shlex.quote(str(file)), results=folder)
    else:
        text = overlay_text(
            PAPER.read_text(encoding="utf-8"),
            file=shlex.quote(str(file)),
            results=folder,
        )
    with whole_file(file) as draft:
        draft.write_text(text, encoding="utf-8")
        read_study(PAPER, draft)
    say(
        f"wrote {file}; edit it, then: squealpipe run --config {shlex.quote(str(file))}"
    )
    return ExitCodes.done


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
    """Compute a study; print one line per rule, the time left if known, and the log of a failure.

    If it is stopped, run the same command again: it resumes with the rules that are not done.

    Example: `squealpipe run --config mine.yaml --quick`

    Args:
        config: configuration laid over the paper's; repeatable.
        quick: coarse grids and short horizons, for a first look.
        cores: cores to use; all by default.
    """
    from squealpipe.study import progress
    from squealpipe.study.explain import snakemake_command
    from squealpipe.study.progress.log import QUIET
    from squealpipe.study.supervised import (
        StoppedError,
        remove_stale_lock,
        run_to_its_end,
        standing_lock,
    )
    from squealpipe.systems.processes import available_cores

    command, study = snakemake_command(config or [], quick=quick)
    for line in study.parameters.became():
        say(line)
    if removed := remove_stale_lock():
        say(removed)
    started = time.perf_counter()
    command += ["--cores", str(cores or "all")]
    env = {**os.environ, **_caches(), **_found_by_snakemake(progress.__path__)}
    if current_session.quiet:
        command += ["--quiet", "all"]
        env[QUIET] = "1"
    else:
        command += ["--logger", "squealpipe"]
        command += ["--logger-squealpipe-cores", str(cores or available_cores())]
        command += ["--logger-squealpipe-results", study.results]
    current_session.remedy = "the same command goes on with the rules that are not done"
    try:
        failed = run_to_its_end(command, env)
    except StoppedError as stop:
        print(f"squealpipe: {stop}; run the same command again", file=sys.stderr)
        return 128 + stop.number
    if failed:
        remedy = standing_lock() or "correct what is reported above"
        print(
            f"squealpipe: the study in {study.results} is not complete; {remedy}, "
            "then run the same command again: what is finished stays",
            file=sys.stderr,
        )
        return ExitCodes.not_done
    say(
        f"done in {duration(time.perf_counter() - started)}: {study.results}/report/index.html"
    )
    return ExitCodes.done


def _found_by_snakemake(folders: Iterable[str]) -> dict[str, str]:
    """A path on which Snakemake finds the plugin that writes one line a rule."""
    there = os.environ.get("PYTHONPATH", "")
    return {"PYTHONPATH": os.pathsep.join([*folders, *filter(None, [there])])}


def _caches() -> dict[str, str]:
    """Give Snakemake and Matplotlib a folder for caches if the home folder cannot be written."""
    if os.access(Path.home(), os.W_OK):
        return {}
    kept = str(Path(".snakemake/cache").resolve())
    return {"XDG_CACHE_HOME": kept, "MPLCONFIGDIR": f"{kept}/matplotlib", **os.environ}
