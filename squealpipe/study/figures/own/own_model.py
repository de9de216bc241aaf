"""The model of each scene at its true angles and lengths, with its numbers."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle

from squealpipe.parameters import direction_of, law_in_words
from squealpipe.plotting.mechanism import SPRING_COLOURS, arrow, displaced_springs
from squealpipe.plotting.origin import parameter
from squealpipe.plotting.style import PAGE, Colour, new_figure, panel_letters, write
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number


@report_figure(
    reads=("own/*",),
    caption=(
        "The model of each scene, springs drawn to scale at their angles. Blue: spring 1; orange: "
        "spring 2; black dots: fixed ends; arcs: α₁ is counted from +x, α₂ from −x; grey line: the "
        "belt, which runs along the red arrow; the contact spring between mass and belt is too "
        "short to be seen at this scale."
    ),
    alt=(
        "A drawing of the mass on two inclined springs above the belt for each scene, with numbers."
    ),
)
def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """One panel for each scene, from datasets ``own/<scene>``."""
    columns = min(len(runs), 3)
    rows = -(-len(runs) // columns)
    figure, axes = new_figure(PAGE, 2.6 * rows, nrows=rows, ncols=columns)
    for panel in axes.flat:
        panel.set_axis_off()
    for panel, run in zip(axes.flat, runs.values(), strict=False):
        _draw(panel, run)
    panel_letters(axes.flat, [name.removeprefix("own/") for name in runs])
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
            f"$k_{index}$ = {engineering(parameter(run, f'k{index}'), 'N m-1')}, "
            f"$L_{index}$ = {engineering(lengths[index - 1], 'm')}, "
            f"$α_{index}$ = {number(np.degrees((alpha1, alpha2)[index - 1]))}°"
        )
        below: dict[str, Any] = {"ha": "center", "va": "top", "fontsize": 6}
        panel.text(0.0, (1.2 + 1.9 * index) * belt, words, color=colour, **below)
    _mark_angles(panel, (alpha1, alpha2), scale)
    panel.add_patch(Circle((0.0, 0.0), 0.05 * scale, fc="white", ec="black", zorder=4))
    panel.plot([-scale, scale], [belt, belt], color=Colour.grey, linewidth=2.0)
    direction = direction_of(parameter(run, "belt_speed"))
    start, end = ((direction * share * scale, 2 * belt) for share in (0.4, 0.9))
    arrow(panel, start, end, 9, Colour.red)
    law = law_in_words(parameter(run, "friction_law")).partition(",")[0]
    from_file = law in {"table", "Python file"}
    friction = f"$μ$: {law}" if from_file else f"$μ$ = {number(parameter(run, 'mu'))}"
    contact = law_in_words(parameter(run, "contact_law")).partition(",")[0]
    spring = (
        "contact: table"
        if contact == "table"
        else f"$k_3$ = {engineering(parameter(run, 'k3'), 'N m-1')}"
    )
    words = (
        f"$m$ = {number(parameter(run, 'mass'))} kg, {spring}\n"
        f"$l_\\mathrm{{pre}}$ = {engineering(parameter(run, 'preload'), 'm')}, "
        f"{friction}, $V$ = {engineering(parameter(run, 'belt_speed'), 'm s-1')}"
    )
    panel.text(0.0, 6.9 * belt, words, **below)
    panel.set(
        xlim=(-1.2 * scale, 1.2 * scale),
        ylim=(-0.85 * scale, 1.1 * scale),
        aspect="equal",
    )


def _mark_angles(panel: Axes, angles: tuple[float, float], scale: float) -> None:
    """Arcs from +x to spring 1 and from −x to spring 2, with the line that they start from."""
    panel.plot([-0.5 * scale, 0.5 * scale], [0, 0], color=Colour.grey, lw=0.6, ls=":")
    for index, (angle, colour) in enumerate(
        zip(angles, SPRING_COLOURS, strict=True), start=1
    ):
        first, last = sorted((0.0, float(np.degrees(angle))))
        arc = (first, last) if index == 1 else (180.0 - last, 180.0 - first)
        size = 0.7 * scale
        panel.add_patch(
            Arc((0, 0), size, size, theta1=arc[0], theta2=arc[1], color=colour, lw=0.8)
        )
        middle = np.radians(0.5 * (arc[0] + arc[1]))
        x, y = (0.44 * scale * part for part in (np.cos(middle), np.sin(middle)))
        write(panel, x, y, f"$α_{index}$", color=colour, fontsize=7)
