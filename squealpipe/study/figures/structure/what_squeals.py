"""Unstable modes of a structure, and the vibration that each grows into."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import squealing
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("structure/squeal",),
    caption=(
        "(a) Growth rate over frequency of the complex modes, as eigenvalue codes draw it; dashed: "
        "the strongest line of each settled motion. (b) Share of the random starts that end in it, "
        "with its 95 % interval. (c) Rms speed of vibration at the contacts. (d) Share of the time "
        "without contact, a bar for each contact. (e) Level of each motion as friction falls, down "
        "to where it dies (cross); dashed: the unstable cycle that it meets there; smaller "
        "vibrations like that one die out."
    ),
    alt=(
        "Growth over frequency, and bars for each settled motion: share of starts, speed, contact "
        "loss; below, speed over friction."
    ),
)
def draw(answer: xr.Dataset) -> Figure:
    """Panels from the dataset ``structure/squeal``."""
    return squealing.figure(answer)
