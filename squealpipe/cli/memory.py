"""Commands about the runs that are kept: which there are, which to find, what nobody needs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from squealpipe.cli.arguments import AsJson
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE
from squealpipe.progress import elapsing

SHOWN = 4
"""Changed parameters of a run that a line shows."""


def list_runs(*, json_: AsJson = False) -> int:
    """List archives and folders of results: date, commit, size, verification, changed parameters.

    Example: `squealpipe list`

    Args:
        json_: print JSON, with the whole configuration of each run.
    """
    from squealpipe.store.memory.catalogue import paper_configuration, runs

    found, paper = runs(), paper_configuration()
    if json_:
        print(json.dumps([_plain(run, paper) for run in found], indent=1))
        return DONE
    if not found:
        print("no archives and no results yet; run snakemake, then squealpipe archive NAME")
        return DONE
    rows = [("name", "date", "commit", "MB", "verified", "differs from the paper's configuration")]
    rows += [
        (
            run.name,
            run.date[:16].replace("T", " "),
            run.commit[:20] or "–",
            f"{run.size / 1e6:.1f}",
            run.verified or ("no" if run.kind == "archive" else "–"),
            _changes(run.changed(paper)),
        )
        for run in found
    ]
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        print("  ".join([*cells, row[-1]]).rstrip())
    return DONE


def find(expression: str, /, *, json_: AsJson = False) -> int:
    """Print the names of the runs whose parameters fulfil a condition; exit code 1: none does.

    Example: `squealpipe find 'mu == 0.25 and L1 > 4'`

    Args:
        expression: comparisons of parameters, of the paper's symbols (L1, V) or of configuration
            keys (linear.points), joined by and, or, not.
        json_: print a JSON list of names.
    """
    from squealpipe.config.settings import Study
    from squealpipe.config.yaml_files import flat
    from squealpipe.parameters import DEFAULTS, TABLE
    from squealpipe.store.memory.catalogue import runs
    from squealpipe.store.memory.expressions import Condition

    known = {f"parameters.{name}": DEFAULTS[name] for name in TABLE if TABLE[name].extension}
    known |= flat(Study().model_dump(mode="json"))
    static, sliding = "parameters.mu_static", "parameters.mu"
    condition = Condition(expression, {**known, static: known[sliding]})
    names = [
        run.name
        for run in runs()
        if run.config and condition.holds({static: run.config.get(sliding), **run.config})
    ]
    print(json.dumps(names) if json_ else "\n".join(names) or "no run fulfils it")
    return DONE if names else ANSWER_IS_NO


def collect_garbage(*, dry_run: Annotated[bool, Parameter(negative="")] = False) -> int:
    """Delete shared contents that no archive refers to, and archives that were left half written.

    Example: `squealpipe gc --dry-run`

    Args:
        dry_run: only tell what would be deleted.
    """
    from squealpipe.store.memory.objects import collect, garbage

    found = garbage() if dry_run else collect()
    word = "would be deleted" if dry_run else "deleted"
    for path in [*found.objects, *found.drafts]:
        print(path)
    count = len(found.objects) + len(found.drafts)
    print(f"{count} {word}, {found.size / 1e6:.1f} MB" if count else "nothing to delete")
    return DONE


def deposit(
    name: str,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
) -> int:
    """Bundle an archive for others: data, figures, report, code, lock, provenance, citation.

    The bundle is checked; its metadata are those that Zenodo and DataCite ask for.

    Example: `squealpipe deposit reference`

    Args:
        name: of the archive.
        output: the bundle to write; by default results/deposit/NAME.zip.
    """
    from squealpipe.store.memory.deposit import bundle

    with elapsing("deposit"):
        path, _ = bundle(name, output=output)
    print(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB), checked")
    return DONE


def _changes(changed: dict[str, Any]) -> str:
    physical = sorted(changed, key=lambda key: (not key.startswith("parameters."), key))
    told = [f"{key.removeprefix('parameters.')}={changed[key]}" for key in physical[:SHOWN]]
    more = len(physical) - len(told)
    return ", ".join([*told, *([f"and {more} more"] if more else [])]) or "nothing"


def _plain(run: Any, paper: dict[str, Any]) -> dict[str, Any]:
    told = {name: getattr(run, name) for name in ("name", "kind", "date", "commit", "size")}
    return {**told, "verified": run.verified, "changed": run.changed(paper), "config": run.config}
