"""What the mass does in each scene: contact force, path and spectrum."""

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.run import draw_force, draw_orbit, draw_spectrum

READS = ("own/*",)
CAPTION = (
    "The motion of model A1 from the start of each scene, one row for each. Left: contact force "
    "over its preload at the beginning of the run; red strips below zero: contact is lost. "
    "Middle: path of the mass, with its end as a dot; dotted: contact is lost above. Right: "
    "amplitude spectrum of the contact force over the whole run."
)
ALT = "For each scene a force history, the path of the mass, and the spectrum of the force."
SHOWN = 0.1
"""Share of the run whose force is drawn at least."""
EVENTS = 8
"""Events that are drawn if the run has them."""


def draw(runs: Mapping[str, xr.Dataset]) -> Figure:
    """Three panels for each scene, from datasets ``own/<scene>``."""
    figure, axes = style.new_figure(
        style.PAGE, 0.3 + 1.8 * len(runs), nrows=len(runs), ncols=3
    )
    letters = iter("abcdefghijklmnopqrstuvwxyz" * len(runs))
    for (history, path, spectrum), (name, run) in zip(axes, runs.items(), strict=True):
        shown = [SHOWN * float(run.time[-1]), *run.event_time.values[:EVENTS]]
        draw_force(history, run.sel(time=slice(0.0, max(shown))))
        draw_orbit(path, run)
        draw_spectrum(spectrum, run)
        for panel in (history, path, spectrum):
            panel.ticklabel_format(scilimits=(-3, 4), useMathText=True)
        style.panel_letter(
            history, next(letters), f"{name.removeprefix('own/')}: force"
        )
        style.panel_letter(path, next(letters), "path")
        style.panel_letter(spectrum, next(letters), "spectrum")
    for panel in axes[:-1].flat:
        panel.set_xlabel("")
    return figure
