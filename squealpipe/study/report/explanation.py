"""The plan of a run for people: a table in the terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from squealpipe.execution.explain import Explanation, why
from squealpipe.progress import duration


def table(explanation: Explanation) -> RenderableType:
    """Rules with reasons and times, then the figures, then the estimate."""
    if not explanation.jobs:
        return Text("nothing to do: every result is up to date", style="green")
    grid = Table(title="will be computed", title_justify="left", title_style="bold")
    grid.add_column("rule")
    grid.add_column("why", overflow="fold")
    grid.add_column("last took", justify="right")
    for job in explanation.jobs:
        time = "never run" if job.seconds is None else duration(job.seconds)
        grid.add_row(job.rule, escape("\n".join(why(job))), time)
    figures = ", ".join(explanation.figures) or "none"
    return Group(grid, Text(f"figures that change: {figures}"), Text(explanation.estimate()))
