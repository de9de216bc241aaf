"""Commands about a whole study: what would run, what was found, frozen and compared."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import AsJson, Configs
from squealpipe.cli.console import console
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE
from squealpipe.progress import elapsing


def explain(*, config: Configs = None, times: bool = False, json_: AsJson = False) -> int:
    """Tell what `snakemake` would compute again, why, which figures change and how long it takes.

    Example: `squealpipe explain --config mine.yaml`

    Args:
        config: configuration laid over the paper's, as for `snakemake --configfile`; repeatable.
        times: print instead what each rule took when it last ran, as a Markdown table.
        json_: print JSON.
    """
    from squealpipe.cli.project import checkout
    from squealpipe.execution.explain import explain as plan_of

    if times:
        _print_times()
        return DONE
    with elapsing("explain"):
        plan = plan_of(config or [], root=checkout(), directory=".")
    if json_:
        print(json.dumps(plan.as_dict(), indent=1))
        return DONE
    from squealpipe.study.report.explanation import table

    console().print(table(plan))
    return DONE


def _print_times() -> None:
    from squealpipe.execution.explain import job_times, records

    times = job_times(records(Path()))
    if not times:
        raise FileNotFoundError("no run is recorded here; run snakemake in this folder first")
    print("| rule | jobs | seconds |\n|---|---:|---:|")
    for rule, seconds in sorted(times.items()):
        print(f"| {rule} | {len(seconds)} | {sum(seconds):.1f} |")
    every = [taken for seconds in times.values() for taken in seconds]
    print(f"| all | {len(every)} | {sum(every):.1f} |")


def archive(
    name: str,
    /,
    *,
    results: Path | None = None,
    config: Configs = None,
    leave_out: Annotated[list[str] | None, Parameter(negative="")] = None,
) -> int:
    """Freeze a run: data, figures, report, configuration, environment and checksums.

    Example: `squealpipe archive before-the-change`

    Args:
        name: of the archive, which goes to results/archive/NAME.
        results: folder of the run; by default the one that the configuration names.
        config: the run's configuration files, later ones laid over earlier ones; repeatable.
        leave_out: suffix (.svg) or path pattern (data/simulate/*) that is not frozen; repeatable.
    """
    from squealpipe.config.settings import PAPER
    from squealpipe.store.archive import archive as freeze

    with elapsing("archive"):
        folder = freeze(
            name, results=results, configs=config or [Path(PAPER)], leave_out=leave_out or []
        )
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    print(f"froze the run in {folder} ({size / 1e6:.1f} MB)")
    return DONE


def verify(name: str, /) -> int:
    """Find any changed, missing or extra byte in an archive; exit code 1 if there is one.

    Example: `squealpipe verify reference`

    Args:
        name: name or folder of the archive.
    """
    from squealpipe.store.archive import verify as check
    from squealpipe.store.memory.catalogue import note_verified

    with elapsing("verify"):
        found = check(name)
    note_verified(found.folder, "intact" if found.intact else "changed")
    for line in found.lines():
        print(line)
    return DONE if found.intact else ANSWER_IS_NO


def compare(
    a: str,
    b: str,
    /,
    *,
    every: Annotated[bool, Parameter(name=["--all", "--every"], negative="")] = False,
    html: Path | None = None,
    json_: AsJson = False,
) -> int:
    """Compare two archives, runs, folders or files, variable by variable.

    Exit code 0: equal or within tolerance; 1: different; 2: not comparable.

    Example: `squealpipe compare reference results`

    Args:
        a: archive name or path.
        b: archive name or path.
        every: tell all of it: also what is equal, and where each side was made.
        html: write a page with pictures: maps that differ, and figures of changed statements.
        json_: print JSON.
    """
    from squealpipe.store.comparison.compare import compare as difference_of

    comparison = difference_of(a, b)
    if html is not None:
        from squealpipe.study.report.comparison import page

        html.write_text(page(comparison), encoding="utf-8")
    if json_:
        print(json.dumps(comparison.as_dict(), indent=1, allow_nan=False))
    else:
        from squealpipe.study.report.comparison import lines

        print("\n".join(lines(comparison, every=every)))
    return comparison.exit_code
