"""Fig. 5: contact forces at (π, π) and (0, 0)."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.dynamics.fig02 import inset_mechanism
from squealpipe.plotting import style
from squealpipe.plotting.run import draw_force
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number


@report_figure(
    reads=("simulate/F5a", "simulate/F5b"),
    caption=(
        "Contact force of model A1 over its preload, started at rest with both springs along the "
        "belt: α₁ = α₂ = π (line) and α₁ = α₂ = 0 (circles). Their largest difference stands above "
        "the panel. Red strips below zero: contact is lost in the run of the line."
    ),
    alt="A history of the contact force, with circles for the second run; red strips off the belt.",
)
def draw(first: xr.Dataset, second: xr.Dataset) -> Figure:
    """One panel, line and circles."""
    figure, axes = style.new_figure(style.PAGE, 2.5)
    panel = axes[0, 0]
    draw_force(panel, first)
    panel.get_lines()[0].set_label(f"α₁ = α₂ = {style.pi_label(float(first.alpha1))}")
    few = second.isel(time=slice(None, None, max(1, first.time.size // 125)))
    panel.plot(
        few.time,
        few.normalized_contact_force,
        "o",
        color=style.Colour.orange,
        mfc="none",
        ms=4,
        label=f"α₁ = α₂ = {style.pi_label(float(second.alpha1))}",
    )
    difference = np.abs(
        first.normalized_contact_force - second.normalized_contact_force
    ).max()
    panel.set_title(f"largest difference {number(float(difference), 2)}", loc="right")
    inset_mechanism(panel, first, (1.0, 0.3, 0.16, 0.7))
    figure.legend(loc="outside upper left", ncols=3)
    return figure
