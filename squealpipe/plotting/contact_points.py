"""Critical friction of a pad on several contact points."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.plotting import style
from squealpipe.plotting.origin import parameter
from squealpipe.structures.schema.contact_points import MOST_FRICTION


def draw_onsets(axes: Axes, pads: xr.Dataset) -> None:
    """Friction at which each pad turns unstable; a triangle where it never does."""
    critical = pads.critical_mu.values
    places = np.arange(len(critical))
    known = np.isfinite(critical)
    axes.plot(places[known], critical[known], "o", color=style.Colour.red)
    axes.plot(
        places[~known],
        np.full((~known).sum(), MOST_FRICTION),
        "^",
        color=style.Colour.blue,
    )
    axes.axhline(
        parameter(pads, "mu"), color=style.Colour.grey, linestyle="--", linewidth=0.8
    )
    names = [str(name).replace(", ", "\n") for name in pads.design.values]
    axes.set_xticks(places, names)
    axes.set(
        xlabel="contact points",
        ylabel="critical friction",
        ylim=(0.0, 1.08 * MOST_FRICTION),
        xlim=(-0.5, len(places) - 0.5),
    )
