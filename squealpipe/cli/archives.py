"""Commands about the runs that are kept: which there are, and which to find."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from squealpipe.cli.arguments import AsJson, OutputElsewhere
from squealpipe.cli.console import ExitCodes, working

if TYPE_CHECKING:
    from squealpipe.study.catalogue import StoredRun


def list_runs(*, json_: AsJson = False) -> int:
    """List archives and folders of results: date, commit, size, state, changed parameters.

    Example: `squealpipe list`

    Args:
        json_: print JSON, with the whole configuration of each run.
    """
    from squealpipe.study.catalogue import paper_configuration, runs

    listed, paper = runs(), paper_configuration()
    if json_:
        print(
            json.dumps(
                [asdict(run) | {"changed": run.changed(paper)} for run in listed],
                indent=1,
            )
        )
        return ExitCodes.done
    if not listed:
        print(
            "no archives and no results yet; run snakemake, then squealpipe archive NAME"
        )
        return ExitCodes.done
    rows = [
        (
            "name",
            "date",
            "commit",
            "MB",
            "files",
            "differs from the paper's configuration",
        )
    ]
    rows += [
        (
            run.name,
            run.date[:16].replace("T", " "),
            run.commit[:20] or "–",
            f"{run.size / 1e6:.1f}",
            "damaged" if run.faults else "intact" if run.finished else "unfinished",
            _changes(run.changed(paper)),
        )
        for run in listed
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        print("  ".join([*cells, row[-1]]).rstrip())
    _warn(listed)
    return ExitCodes.done


def find(expression: str, /, *, json_: AsJson = False) -> int:
    """Print the names of the runs whose parameters fulfil a condition; exit code 1: none does.

    Example: `squealpipe find 'mu == 0.25 and L1 > 4'`

    Args:
        expression: comparisons of parameters, of the paper's symbols (L1, V) or of configuration
            keys (linear.points), joined by and, or, not, as pandas reads them.
        json_: print a JSON list of names.
    """
    from squealpipe.study.catalogue import matching, runs

    known_runs = runs()
    names = matching(expression, known_runs)
    _warn(known_runs)
    print(json.dumps(names) if json_ else "\n".join(names) or "no run fulfils it")
    return ExitCodes.done if names else ExitCodes.answer_is_no


def deposit(name: str, /, *, output: OutputElsewhere = None) -> int:
    """Bundle an archive for others: data, figures, report, code, lock and citation.

    Example: `squealpipe deposit reference`

    Args:
        name: of the archive.
        output: the bundle to write; by default results/deposit/NAME.zip.
    """
    from squealpipe.store.deposit import bundle

    with working("deposit"):
        path = bundle(name, output=output)
    print(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return ExitCodes.done


def _warn(found: list[StoredRun]) -> None:
    """Name the files that are not as they were written; the rest is listed all the same."""
    for run in found:
        for fault in run.faults:
            print(f"{run.name}: {fault}", file=sys.stderr)


def _changes(changed: dict[str, Any]) -> str:
    physical = sorted(changed, key=lambda key: (not key.startswith("parameters."), key))
    # the line of a run stays within a terminal's width
    stated = [
        f"{key.removeprefix('parameters.')}={changed[key]}" for key in physical[:4]
    ]
    more = len(physical) - len(stated)
    return ", ".join([*stated, *([f"and {more} more"] if more else [])]) or "nothing"
