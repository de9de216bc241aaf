"""The settled motion of each scene: orbit, contact force, spectrum in Hz."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.assess import draw_row
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("assess/*",),
    caption=(
        "The settled motion of each scene, one row for each. Left: path of the mass, coloured by "
        "what it does; dotted: contact is lost above. Middle: contact force over the preload "
        "force; red strips below zero: contact is lost. Right: amplitude of the velocity over the "
        "frequency; the triangle marks the strongest line."
    ),
    alt=(
        "For each scene the path of the mass, the contact force over time, and a spectrum in hertz."
    ),
)
def draw(answers: Mapping[str, xr.Dataset]) -> Figure:
    """Three panels for each scene, from datasets ``assess/<scene>``."""
    figure, axes = style.new_figure(
        style.PAGE, 0.2 + 2.1 * len(answers), nrows=len(answers), ncols=3
    )
    for row, (name, answer) in zip(axes, answers.items(), strict=True):
        draw_row(row, answer)
        row[0].set_title(name.removeprefix("assess/"), loc="left", fontweight="bold")
    return figure
