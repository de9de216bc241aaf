"""The model of each scene at its true angles and lengths, with its numbers."""

from collections.abc import Mapping
from string import ascii_lowercase
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from squealpipe.parameters import direction_of, law_in_words
from squealpipe.plotting.mechanism import SPRING_COLOURS, arrow, displaced_springs
from squealpipe.plotting.origin import parameter
from squealpipe.plotting.style import GREY, PAGE, RED, new_figure, panel_letter
from squealpipe.text import number

READS = ("own/*",)
CAPTION = (
    "The model of each scene, springs drawn to scale at their angles. Blue: spring 1; orange: "
    "spring 2; black dots: fixed ends; grey line: the belt, which runs along the red arrow; the "
    "contact spring between mass and belt is too short to be seen at this scale."
)
ALT = "A drawing of the mass on two inclined springs above the belt for each scene, with numbers."


def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """One panel for each scene, from datasets ``own/<scene>``."""
    columns = min(len(runs), 3)
    rows = -(-len(runs) // columns)
    figure, axes = new_figure(PAGE, 2.6 * rows, nrows=rows, ncols=columns)
    for panel in axes.flat:
        panel.set_axis_off()
    for letter, panel, (name, run) in zip(
        ascii_lowercase, axes.flat, runs.items(), strict=False
    ):
        _draw(panel, run)
        panel_letter(panel, letter, name.removeprefix("own/"))
    return figure


def _draw(panel: Axes, run: xr.Dataset) -> None:
    alpha1, alpha2 = float(run.alpha1), float(run.alpha2)
    lengths = parameter(run, "length1"), parameter(run, "length2")
    scale = max(lengths)
    springs = displaced_springs(0.0, 0.0, alpha1, alpha2, lengths, 0.03 * scale)
    belt = -0.07 * scale
    for index, (path, colour) in enumerate(
        zip(springs, SPRING_COLOURS, strict=True), start=1
    ):
        panel.plot(*path.T, color=colour, linewidth=1.0)
        panel.add_patch(Circle(tuple(path[-1]), 0.02 * scale, color="black"))
        words = (
            f"$k_{index}$ = {number(parameter(run, f'k{index}'))} N/m, "
            f"$L_{index}$ = {number(lengths[index - 1])} m, "
            f"$α_{index}$ = {number(np.degrees((alpha1, alpha2)[index - 1]))}°"
        )
        below: dict[str, Any] = {"ha": "center", "va": "top", "fontsize": 6}
        panel.text(0.0, (1.2 + 1.9 * index) * belt, words, color=colour, **below)
    panel.add_patch(Circle((0.0, 0.0), 0.05 * scale, fc="white", ec="black", zorder=4))
    panel.plot([-scale, scale], [belt, belt], color=GREY, linewidth=2.0)
    direction = direction_of(parameter(run, "belt_speed"))
    start, end = ((direction * share * scale, 2 * belt) for share in (0.4, 0.9))
    arrow(panel, start, end, 9, RED)
    law = law_in_words(parameter(run, "friction_law")).partition(",")[0]
    own = law in {"table", "Python file"}
    friction = f"$μ$: {law}" if own else f"$μ$ = {number(parameter(run, 'mu'))}"
    contact = law_in_words(parameter(run, "contact_law")).partition(",")[0]
    spring = (
        "contact: table"
        if contact == "table"
        else f"$k_3$ = {number(parameter(run, 'k3'))} N/m"
    )
    words = (
        f"$m$ = {number(parameter(run, 'mass'))} kg, {spring}\n"
        f"$l_\\mathrm{{pre}}$ = {number(parameter(run, 'preload'))} m, "
        f"{friction}, $V$ = {number(parameter(run, 'belt_speed'))} m/s"
    )
    panel.text(0.0, 6.9 * belt, words, **below)
    panel.set(
        xlim=(-1.2 * scale, 1.2 * scale),
        ylim=(-0.75 * scale, 1.1 * scale),
        aspect="equal",
    )
