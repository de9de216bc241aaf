"""A comparison for people: a table in the terminal, a page with pictures."""

from __future__ import annotations

import base64
import io
import math
from typing import Any

import jinja2
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from squealpipe.figures.difference import CAPTION, draw, drawable
from squealpipe.schema import find
from squealpipe.store.compare import Comparison, DatasetDifference
from squealpipe.store.differences import VariableDifference, Verdict, align
from squealpipe.store.netcdf import load

STYLES = {
    Verdict.equal: "green",
    Verdict.within_tolerance: "green",
    Verdict.different: "bold red",
    Verdict.not_comparable: "bold yellow",
}
MOST_PICTURES = 12


def table(comparison: Comparison, *, every: bool = False) -> RenderableType:
    """Changed parameters first, then what differs, then the verdict.

    Args:
        comparison: of two places.
        every: also list what is equal.
    """
    parts: list[RenderableType] = []
    for title, changes in (
        ("changed parameters", comparison.parameters),
        ("made elsewhere", comparison.environment),
    ):
        if changes:
            parts.append(_changes(title, comparison, changes))
    listed = [item for item in comparison.datasets if every or _says_something(item)]
    if listed:
        parts.append(_datasets(listed, every=every))
    parts.append(
        Text(f"{verdict_line(comparison)}", style=STYLES[comparison.verdict], overflow="fold")
    )
    return Group(*parts)


def verdict_line(comparison: Comparison) -> str:
    """For instance ``different: 2 of 9 datasets (equal 6, within tolerance 1)``."""
    if comparison.reason:
        return f"not comparable: {comparison.reason}"
    counts = {
        verdict: sum(item.verdict == verdict for item in comparison.datasets) for verdict in Verdict
    }
    told = ", ".join(f"{words(verdict)} {count}" for verdict, count in counts.items() if count)
    total = len(comparison.datasets)
    skipped = f"; left out of the archive: {', '.join(comparison.skipped)}"
    line = f"{words(comparison.verdict)}: {total} dataset{'s' * (total != 1)} ({told})"
    return line + skipped if comparison.skipped else line


def words(verdict: Verdict) -> str:
    """A verdict as words."""
    return verdict.name.replace("_", " ")


def where(entry: VariableDifference) -> str:
    """The place of the largest difference; angles in multiples of π."""
    return ", ".join(f"{dim} = {_place(dim, value)}" for dim, value in entry.where.items())


def how_much(entry: VariableDifference) -> str:
    """Size of the difference in words."""
    if entry.reason and not entry.compared:
        return entry.reason
    if entry.flips:
        return f"{entry.differing} flipped: " + ", ".join(
            f"{pair} {count}" for pair, count in entry.flips.items()
        )
    if entry.verdict == Verdict.equal:
        return ""
    told = (
        f"abs {entry.largest_absolute:.3g}, rel {entry.largest_relative:.3g}, "
        f"{entry.differing} of {entry.compared} beyond rtol {entry.rtol:g}, atol {entry.atol:g}"
    )
    return f"{told}; {entry.reason}" if entry.reason else told


def page(comparison: Comparison) -> str:
    """One self-contained HTML page with pictures of the maps that differ."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("squealpipe.report", "templates"), autoescape=True
    )
    template = environment.get_template("comparison.html.j2")
    return template.render(
        comparison=comparison,
        verdict=verdict_line(comparison),
        pictures=_pictures(comparison),
        caption=CAPTION,
        words=words,
        where=where,
        how_much=how_much,
        Verdict=Verdict,
    )


def _changes(title: str, comparison: Comparison, changes: dict[str, tuple[Any, Any]]) -> Table:
    grid = Table(title=title, title_justify="left", title_style="bold")
    grid.add_column("key")
    grid.add_column(escape(comparison.a), overflow="fold")
    grid.add_column(escape(comparison.b), overflow="fold")
    for key, pair in changes.items():
        grid.add_row(escape(key), *(escape("–" if value is None else str(value)) for value in pair))
    return grid


def _says_something(item: DatasetDifference) -> bool:
    equal = all(entry.verdict == Verdict.equal for entry in item.variables)
    return not equal or bool(item.notes) or item.verdict != Verdict.equal


def _datasets(datasets: list[DatasetDifference], *, every: bool) -> Table:
    grid = Table(title="variables", title_justify="left", title_style="bold")
    for column in ("dataset", "variable", "verdict", "difference", "where"):
        grid.add_column(column, overflow="fold")
    for item in datasets:
        style = STYLES[item.verdict]
        note = "; ".join([item.reason, *item.notes] if item.reason else item.notes)
        grid.add_row(escape(item.name), "", Text(words(item.verdict), style=style), escape(note))
        for entry in item.variables:
            if entry.verdict == Verdict.equal and not every:
                continue
            shown = "volatile" if entry.volatile else words(entry.verdict)
            grid.add_row(
                "",
                escape(entry.name),
                Text(shown, style="dim" if entry.volatile else STYLES[entry.verdict]),
                escape(how_much(entry)),
                escape(where(entry)),
            )
    return grid


def _place(dim: str, value: float | str) -> str:
    if isinstance(value, str):
        return value
    return f"{value / math.pi:.4g}π" if dim.startswith("alpha") else f"{value:.6g}"


def _pictures(comparison: Comparison) -> list[dict[str, str]]:
    wanted = [
        (item, entry)
        for item in comparison.datasets
        for entry in item.variables
        if entry.verdict == Verdict.different and entry.compared and not entry.volatile
    ]
    wanted.sort(key=lambda pair: pair[1].differing / pair[1].compared, reverse=True)
    pictures: list[dict[str, str]] = []
    for item, entry in wanted:
        if len(pictures) == MOST_PICTURES:
            break
        picture = _picture(item, entry)
        if picture:
            title = f"{item.name}: {entry.name}"
            pictures.append({"title": title, "source": f"data:image/png;base64,{picture}"})
    return pictures


def _picture(item: DatasetDifference, entry: VariableDifference) -> str:
    """PNG of one variable as base64; empty where it is not a map."""
    first, second = item.files
    if first is None or second is None:
        return ""
    a, b, _ = align(load(first), load(second))
    line = find(str(a.attrs["schema"])).lookup(entry.name)
    if line is None or not drawable(a[entry.name]):
        return ""
    buffer = io.BytesIO()
    draw(entry.name, a[entry.name], b[entry.name], line).savefig(buffer, format="png", dpi=130)
    return base64.b64encode(buffer.getvalue()).decode()
