"""Propensities over uncertain parameters, and what they depend on."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.propensity import figure
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("propensity",),
    caption=(
        "Propensities over the distributed parameters of the study. (a) Share of the sample in "
        "which each occurs, with its 95 % interval. (b) The share from growing parts of the "
        "sample. (c) Total Sobol indices with 95 % intervals, dots: first order; a quantity for "
        "which the sample does not support an index is left out. (d) Half-width of the widest "
        "total index from growing parts of the base sample; an index is given only below the "
        "dashed line. Colours as in (a)."
    ),
    alt=(
        "Bars of shares, lines of shares over sample size, and bars of sensitivity indices."
    ),
)
def draw(propensity: xr.Dataset) -> Figure:
    """Draw shares, their convergence and sensitivity indices."""
    return figure(propensity)
