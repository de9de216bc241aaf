"""Commands about a whole study: what would run, what was found, frozen and compared."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE

if TYPE_CHECKING:
    from squealpipe.store.compare import Comparison
    from squealpipe.store.differences import VariableDifference

AsJson = Annotated[bool, Parameter(name="--json", negative="")]
Configs = Annotated[list[Path] | None, Parameter(name=["--config", "-c"], negative="")]
BASE_CONFIG = Path("workflow/config/paper.yaml")


def explain(*, config: Configs = None, times: bool = False, json_: AsJson = False) -> int:
    """Tell what `snakemake` would compute again, why, which figures change and how long it takes.

    Example: `squealpipe explain --config mine.yaml`

    Args:
        config: configuration laid over the paper's, as for `snakemake --configfile`; repeatable.
        times: print instead what each rule took when it last ran, as a Markdown table.
        json_: print JSON.
    """
    from squealpipe.explain import explain as plan_of

    if times:
        _print_times()
        return DONE
    plan = plan_of(config or [])
    print(json.dumps(plan.as_dict(), indent=1) if json_ else "\n".join(plan.lines()))
    return DONE


def _print_times() -> None:
    from squealpipe.explain import records

    jobs = {(record.rule, record.ended): record.seconds for record in records(Path()).values()}
    if not jobs:
        raise FileNotFoundError("no run is recorded here; run snakemake in this folder first")
    print("| rule | jobs | seconds |\n|---|---:|---:|")
    for rule in sorted({rule for rule, _ in jobs}):
        seconds = [taken for (name, _), taken in jobs.items() if name == rule]
        print(f"| {rule} | {len(seconds)} | {sum(seconds):.1f} |")
    print(f"| all | {len(jobs)} | {sum(jobs.values()):.1f} |")


def claims(file: Path = Path("results/data/claims.nc"), /, *, json_: AsJson = False) -> int:
    """Print the paper's statements with their measured values and verdicts.

    With the shipped parameters, exit code 1 tells that a verdict differs from the recorded one.

    Example: `squealpipe claims --json`

    Args:
        file: dataset of verdicts, made by `snakemake`.
        json_: print a JSON list of objects.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from squealpipe.claims.table import table as verdicts

    rows, code = verdicts(file)
    if json_:
        print(json.dumps(rows, indent=1, allow_nan=False))
        return code
    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("id", "statement", "verdict", "value", "evidence"):
        shown.add_column(name, overflow="fold")
    for row in rows:
        value = "" if row["value"] is None else f"{row['value']:.4g}"
        shown.add_row(row["id"], row["statement"], row["verdict"], value, row["evidence"])
    Console().print(shown)
    return code


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
        leave_out: suffix of files that are not frozen, for instance .svg; repeatable.
    """
    from squealpipe.store.archive import archive as freeze

    folder = freeze(
        name, results=results, configs=config or [BASE_CONFIG], leave_out=leave_out or []
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

    found = check(name)
    for line in found.lines():
        print(line)
    return DONE if found.intact else ANSWER_IS_NO


def compare(a: str, b: str, /, *, json_: AsJson = False) -> int:
    """Compare two archives, runs, folders or files, variable by variable.

    Exit code 0: equal or within tolerance; 1: different; 2: not comparable.

    Example: `squealpipe compare reference results`

    Args:
        a: archive name or path.
        b: archive name or path.
        json_: print JSON.
    """
    from squealpipe.store.compare import compare as difference_of

    comparison = difference_of(a, b)
    if json_:
        print(json.dumps(comparison.as_dict(), indent=1, allow_nan=False))
    else:
        _show(comparison)
    return comparison.exit_code


def _show(comparison: Comparison) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console()
    for heading, changes in (
        ("changed parameters", comparison.parameters),
        ("changed environment", comparison.environment),
    ):
        for key, (left, right) in changes.items():
            console.print(f"{heading}: {key}: {left} → {right}", markup=False)
    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("dataset", "variable", "verdict", "largest difference", "where"):
        shown.add_column(name, overflow="fold")
    for dataset in comparison.datasets:
        shown.add_row(dataset.name, "", dataset.verdict.name, dataset.reason, "")
        for entry in dataset.variables:
            if entry.verdict:
                shown.add_row("", entry.name, entry.verdict.name, *_difference(entry))
    console.print(shown)
    console.print(
        f"{comparison.a} and {comparison.b}: {comparison.verdict.name.replace('_', ' ')}"
        + (f": {comparison.reason}" if comparison.reason else ""),
        markup=False,
    )


def _difference(entry: VariableDifference) -> tuple[str, str]:
    """How much and where, in words."""
    if entry.reason or entry.flips:
        flips = (f"{change}: {count} times" for change, count in entry.flips.items())
        return "; ".join(filter(None, (entry.reason, *flips))), _place(entry)
    amount = (
        f"{entry.largest_absolute:.3g} ({entry.largest_relative:.2g} relative), "
        f"{entry.differing} of {entry.compared} beyond tolerance"
    )
    return amount, _place(entry)


def _place(entry: VariableDifference) -> str:
    parts = (
        f"{name} = {value:.6g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in entry.where.items()
    )
    return ", ".join(parts)
