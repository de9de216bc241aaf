"""A comparison for people: a screenful in the terminal."""

import math
from collections.abc import Iterator
from typing import Any

from squealpipe.store.comparison.compare import Comparison, DatasetDifference
from squealpipe.store.comparison.differences import (
    Agreement,
    VariableDifference,
    shortened,
)
from squealpipe.store.comparison.statements import StatementChange
from squealpipe.systems.datasets.agreement import ComparedAs


def lines(comparison: Comparison, *, every: bool = False) -> list[str]:
    """The answer, changed parameters, changed statements, what differs (worst first); for people.

    Args:
        every: all of it, with what is equal and where each side was made; else a screenful.
    """
    worst = sorted(comparison.datasets, key=lambda item: item.severity, reverse=True)
    verdicts = sum(change.verdict_changed for change in comparison.statements)
    values = len(comparison.statements) - verdicts
    title = f"statements of the paper: {verdicts} changed their verdict, {values} only a value"
    parts = {
        "changed parameters": (6, _changes(comparison.parameters)),
        title: (5, [statement_line(change) for change in comparison.statements]),
        "compared in part": (
            4,
            [
                f"{item.name}: {note}"
                for item in comparison.datasets
                for note in item.notes
            ],
        ),
        "differences, worst first": (
            6,
            [line for item in worst for line in _dataset_lines(item, every=every)],
        ),
        "made elsewhere": (0, _changes(comparison.environment)),
    }
    stated = [verdict_line(comparison)]
    for heading, (most, part) in parts.items():
        shown = part
        if not every and len(part) > most:
            more = f"and {len(part) - most + 1} more; --all shows them"
            shown = [*part[: most - 1], more] if most else []
        stated += [heading, *(f"  {line}" for line in shown)] if shown else []
    if every:
        return stated
    width = 100
    return [
        shortened(stated[0], 3 * width),
        *(shortened(line, width) for line in stated[1:]),
    ]


def statement_line(change: StatementChange) -> str:
    """Return for instance ``S3: holds → fails, 0.96 → 0.71``."""
    verdicts = [verdict or "not judged" for verdict in change.verdicts]
    values = ["–" if value is None else f"{value:.4g}" for value in change.values]
    stated = " → ".join(verdicts) if change.verdict_changed else verdicts[0]
    return f"{change.claim}: {stated}, value {values[0]} → {values[1]}"


def _changes(changes: dict[str, tuple[Any, Any]]) -> list[str]:
    return [
        f"{key}: " + " → ".join("–" if value is None else str(value) for value in pair)
        for key, pair in changes.items()
    ]


def _dataset_lines(item: DatasetDifference, *, every: bool) -> Iterator[str]:
    if item.reason or (every and (item.notes or not item.variables)):
        yield f"{item.name}: {words(item.verdict)}; " + "; ".join(
            filter(None, [item.reason, *item.notes])
        )
    equal = [entry for entry in item.variables if entry not in item.differences]
    for entry in [*item.differences, *(equal if every else [])]:
        verdict = (
            "" if entry.verdict == Agreement.different else f"{words(entry.verdict)} "
        )
        kind = "volatile " if entry.volatile else verdict
        at = f" at {where(entry)}" if entry.where else ""
        yield f"{item.name}.{entry.name}: {kind}{how_much(entry)}{at}"


def verdict_line(comparison: Comparison) -> str:
    """Return a line like ``different: 9 datasets (equal 8, different 1), 820 of 900 values …``."""
    if comparison.reason:
        return f"not comparable: {comparison.reason}"
    counts = {
        verdict: sum(item.verdict == verdict for item in comparison.datasets)
        for verdict in Agreement
    }
    stated = ", ".join(
        f"{words(verdict)} {count}" for verdict, count in counts.items() if count
    )
    total = len(comparison.datasets)
    compared = sum(item.compared for item in comparison.datasets)
    values = sum(item.values for item in comparison.datasets)
    skipped = f"; left out of the archive: {', '.join(comparison.skipped)}"
    line = (
        f"{words(comparison.verdict)}: {total} dataset{'s' * (total != 1)} ({stated}), "
        f"{compared:,} of {values:,} values compared"
    )
    return line + skipped if comparison.skipped else line


def words(verdict: Agreement) -> str:
    """A verdict as words."""
    return verdict.name.replace("_", " ")


def where(entry: VariableDifference) -> str:
    """The place of the largest difference; angles in multiples of π."""
    places = [
        f"{dim} = {value}"
        if isinstance(value, str)
        else f"{dim} = {value / math.pi:.4g}π"
        if dim.startswith("alpha")
        else f"{dim} = {value:.6g}"
        for dim, value in entry.where.items()
    ]
    return ", ".join(places)


def how_much(entry: VariableDifference) -> str:
    """Size of the difference in words."""
    if entry.reason and (
        not entry.compared or entry.compared_as == ComparedAs.sample.value
    ):
        return entry.reason
    if entry.flips:
        return f"{entry.differing} flipped: " + ", ".join(
            f"{pair} {count}" for pair, count in entry.flips.items()
        )
    if entry.verdict == Agreement.equal:
        return ""
    allowed = entry.compared_as or f"rtol {entry.rtol:g}, atol {entry.atol:g}"
    stated = (
        f"{entry.differing} of {entry.compared} beyond {allowed}; "
        f"largest {entry.largest_absolute:.3g}, relative {entry.largest_relative:.3g}"
    )
    return f"{stated}; {entry.reason}" if entry.reason else stated
