"""Commands about a whole study: what would run, what was found, frozen and compared."""

import json
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import AsJson, Configs, Switch, Texts
from squealpipe.cli.console import ExitCodes, answer, working
from squealpipe.systems.inputs.words import duration


def explain(
    *,
    config: Configs = None,
    quick: Switch = False,
    time: Switch = False,
    json_: AsJson = False,
) -> int:
    """State what `snakemake` would compute again, why, which figures change and how long it takes.

    Example: `squealpipe explain --config mine.yaml`

    Args:
        config: configuration laid over the paper's, as for `snakemake --configfile`; repeatable.
        quick: coarse grids and short horizons, as for `squealpipe run --quick`.
        time: print instead the CPU seconds that each rule took when it last ran in this folder, and
            how many of them went into compiling.
        json_: print JSON.
    """
    if time:
        return _tell_costs(json_=json_)
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from squealpipe.store.rerun.sources import PACKAGE
    from squealpipe.study.explain import explain as plan_of

    with working("explain"):
        plan = plan_of(config or [], quick=quick)
    if json_:
        print(json.dumps(plan.as_dict(), indent=1))
        return ExitCodes.done
    for line in plan.became:
        print(line)
    if not plan.jobs:
        print("nothing to do: every result is up to date")
        return ExitCodes.done
    grid = Table(
        "rule", "why", "last took", title="will be computed", title_justify="left"
    )
    for job in plan.jobs:
        took = "never run" if job.seconds is None else duration(job.seconds)
        grid.add_row(job.rule, escape(job.why()), took)
    Console().print(grid)
    print(
        f"figures that change: {', '.join(plan.figures) or 'none'}\n{plan.estimate()}\n"
        f"code: that of {PACKAGE}"
    )
    return ExitCodes.done


def _tell_costs(*, json_: bool) -> int:
    """Print the CPU time of the jobs that have run in this folder, the longest first."""
    from pathlib import Path

    from squealpipe.study.durations import job_costs

    costs = job_costs(Path())
    if json_:
        plain = {rule: cost._asdict() for rule, cost in costs.items()}
        print(json.dumps(plain, indent=1))
        return ExitCodes.done
    if not costs:
        print("no job has run in this folder; `squealpipe run` runs the study")
        return ExitCodes.done
    from rich.console import Console
    from rich.table import Table

    total = [sum(cost[part] or 0.0 for cost in costs.values()) for part in range(3)]
    grid = Table(title="seconds of the last runs", title_justify="left")
    grid.add_column("rule")
    for name in ("CPU", "of which compiling", "clock"):
        grid.add_column(name, justify="right")
    for rule, cost in [*costs.items(), ("all", total)]:
        grid.add_row(rule, *("" if each is None else f"{each:.1f}" for each in cost))
    Console().print(grid)
    return ExitCodes.done


def archive(name: str, /, *, config: Configs = None, leave_out: Texts = None) -> int:
    """Freeze a run: data, figures, report, configuration, environment and checksums.

    Every result that the rules make must be there, made with this configuration and code.

    Example: `squealpipe archive before-the-change`

    Args:
        name: of the archive, which goes to results/archive/NAME.
        config: the run's configuration laid over the paper's, as for `squealpipe run`; repeatable.
        leave_out: suffix (.svg) or path pattern (data/simulate/*) that is not frozen; repeatable.
    """
    from squealpipe.study.archive import archive as freeze
    from squealpipe.study.configuration.settings import PAPER
    from squealpipe.study.explain import explain as plan_of

    with working("archive"):
        # a configuration that was given whole may be the paper's own
        overlays = [path for path in config or [] if not path.samefile(PAPER)]
        plan = plan_of(overlays)
        folder = freeze(
            name, keys=plan.keys, configs=[PAPER, *overlays], leave_out=leave_out or []
        )
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    print(f"froze the run in {folder} ({size / 1e6:.1f} MB)")
    return ExitCodes.done


def verify(name: str, /) -> int:
    """Find any changed, missing or extra byte in an archive; exit code 1 if there is one.

    Example: `squealpipe verify reference`

    Args:
        name: name or folder of the archive.
    """
    from squealpipe.store.runs import verify as check

    with working("verify"):
        faults = check(name)
    answer(*faults.lines())
    return ExitCodes.done if faults.intact else ExitCodes.answer_is_no


def compare(
    a: str,
    b: str,
    /,
    *,
    every: Annotated[bool, Parameter(name=["--all", "--every"], negative="")] = False,
    json_: AsJson = False,
) -> int:
    """Compare two archives, runs, folders or files, variable by variable.

    Exit code 0: equal or within tolerance; 1: different; 2: not comparable.

    Example: `squealpipe compare reference results`

    Args:
        a: archive name or path.
        b: archive name or path.
        every: report everything, including what is equal and where each side was made.
        json_: print JSON.
    """
    from squealpipe.store.comparison.compare import compare as difference_of

    with working("compare"):
        comparison = difference_of(a, b)
    if json_:
        print(json.dumps(comparison.as_dict(), indent=1, allow_nan=False))
    else:
        from squealpipe.store.comparison.lines import lines

        print("\n".join(lines(comparison, every=every)))
    return comparison.exit_code
