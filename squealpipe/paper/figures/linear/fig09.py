"""Fig. 9: the second natural frequency over both spring angles."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.paper.figures.panels.frequency_map import draw_mode
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("natural_frequencies",),
    caption=(
        "Second natural frequency ω₂ of model A4 (a) in contact, Eq. (22b), and (b) separated, "
        "Eq. (25b). Lines and hatching as in Fig. 8."
    ),
    alt=(
        "Two maps of the second natural frequency over both spring angles, in contact and "
        "separated."
    ),
)
def draw(frequencies: xr.Dataset) -> Figure:
    """Draw the second frequency in contact and separated, with one colour scale."""
    return draw_mode(frequencies, mode=2)
