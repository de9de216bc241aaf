"""Fig. 8: the first natural frequency over both spring angles."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.panels.frequency_map import LINES_AND_HATCHING, draw_mode
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("natural_frequencies",),
    caption=(
        "First natural frequency ω₁ of model A4 (a) in contact, Eq. (22a), and (b) separated, "
        f"Eq. (25a). {LINES_AND_HATCHING}"
    ),
    alt=(
        "Two maps of the first natural frequency over both spring angles, in contact and separated."
    ),
)
def draw(frequencies: xr.Dataset) -> Figure:
    """Draw the first frequency in contact and separated, with one colour scale."""
    return draw_mode(frequencies, mode=1)
