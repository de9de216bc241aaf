"""Operating points of a structure: verdict and frequency, and occurrence by bands."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import operating_map
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("structure/operating",),
    caption=(
        "Above: verdict at each pressure and speed, one map for each friction or temperature; the "
        "colour of a noisy point is its strongest line. Below: share of all points that are noisy "
        "in each band of frequencies, and, where a list of measured noises is given, the share of "
        "its lines."
    ),
    alt=(
        "Maps of marks over speed and pressure, coloured by frequency, and bars in per cent over "
        "bands of frequency."
    ),
)
def draw(points: xr.Dataset) -> Figure:
    """Maps and bars from the dataset ``structure/operating``."""
    return operating_map.figure(points)
