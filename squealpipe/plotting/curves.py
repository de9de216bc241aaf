"""Curves over two parameters: where contact is lost, and where steady sliding turns unstable."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.codes import flag_words
from squealpipe.plotting import style
from squealpipe.plotting.quantities import label
from squealpipe.schema import meanings


def draw_curves(axes: Axes, curves: xr.Dataset) -> None:
    """Each kind of curve in a colour of its own, designs as crosses; or that there is none."""
    if not curves.sizes["point"]:
        style.say_instead(axes, "no curve within these ranges")
        return
    followed = curves.attrs.get("parameters_followed", "alpha1 alpha2").split()
    names = curves.parameter.values if "parameter" in curves else followed
    x, y = (curves[str(name)] for name in names)
    one = xr.zeros_like(x, dtype=int)
    # variables that number the pieces of one curve
    number = next(
        (curves[name] for name in ("segment", "curve") if name in curves), one
    ).values
    # variables that tell which curve a point lies on, in datasets of several curves
    kind = next((curves[name] for name in ("line", "boundary") if name in curves), one)
    words = meanings(kind) or {0: curves.attrs.get("curve", "boundary of kept contact")}
    for colour, code in zip(
        style.Colour.palette * len(words), np.unique(kind.values), strict=False
    ):
        on = kind.values == code
        lines = (x.values[on], y.values[on])
        style.draw_lines(
            axes, lines, number[on], color=colour, label=flag_words(words[code])
        )
    if "design" in curves:
        axes.plot(*curves.design.values.T, "x", color=style.Colour.red, label="design")
    axes.set(xlabel=label(x), ylabel=label(y))
    axes.legend(fontsize="small")
