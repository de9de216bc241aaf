"""Fig. 2: contact force of model A1 in four spring arrangements."""

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.parameters import direction_of
from squealpipe.plotting import style
from squealpipe.plotting.mechanism import draw_mechanism
from squealpipe.plotting.origin import parameter
from squealpipe.plotting.run import draw_force
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("simulate/F2a", "simulate/F2b", "simulate/F2c", "simulate/F2d"),
    caption=(
        "Contact force of model A1 over its preload, started at rest, in the four spring "
        "arrangements of the paper, each drawn beside its panel. Red strips below zero: contact is "
        "lost."
    ),
    alt="Four histories of the contact force with their springs; red strips mark lost contact.",
)
def draw(*runs: xr.Dataset) -> Figure:
    """Four panels in the order of the paper."""
    figure, axes = style.new_figure(
        style.PAGE, 4.3, nrows=2, ncols=2, sharex=True, sharey=True
    )
    for panel, letter, run in zip(axes.flat, "abcd", runs, strict=True):
        draw_force(panel, run)
        angles = style.pi_label(float(run.alpha1)), style.pi_label(float(run.alpha2))
        style.panel_letter(panel, letter, f"α₁ = {angles[0]}, α₂ = {angles[1]}")
        inset_mechanism(panel, run, (1.005, 0.3, 0.27, 0.6))
        panel.label_outer()
    return figure


def inset_mechanism(
    axes: Axes, run: xr.Dataset, place: tuple[float, float, float, float]
) -> None:
    """The spring arrangement of a run with its belt, at a place in axes fractions."""
    inset = axes.inset_axes(place)
    direction = direction_of(parameter(run, "belt_speed"))
    draw_mechanism(inset, float(run.alpha1), float(run.alpha2), direction=direction)
