"""Axes in other units: a tick shows the value that stands there, in the unit of its label."""

import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.parameters import Parameters
from squealpipe.plotting.axis_units import in_units

REAL = Parameters(k1=1e7, k2=1e7, k3=7e6, mass=0.45, preload=5e-4, length1=0.02)


@pytest.mark.parametrize(
    ("wanted", "axis", "tick"),
    [
        # a brake of the size of a real one takes what people write
        ((), ("frequency (kHz)", 2e3 * np.pi, "1"), ("force (kN)", 1e4, "$10^{1}$")),
        (
            ("Hz", "N"),
            ("frequency (Hz)", 2e3 * np.pi, "1000"),
            ("force (N)", 1e4, "$10^{4}$"),
        ),
    ],
)
def test_ticks_are_in_the_unit_of_the_label_on_linear_and_logarithmic_axes(
    wanted, axis, tick
):
    figure = Figure()
    axes = figure.subplots()
    axes.set(xlabel="ω (rad/s)", xlim=(0.0, 1e4 * np.pi), ylabel="force (N)")
    axes.set(yscale="log", ylim=(1e2, 1e5))
    made = xr.Dataset(attrs={"parameters": json.dumps(REAL.as_dict())})
    in_units(figure, wanted, made)
    for each, (label, place, shown) in zip(
        (axes.xaxis, axes.yaxis), (axis, tick), strict=True
    ):
        assert each.get_label_text() == label
        assert each.get_major_formatter()(place) == shown
        ticks = each.get_major_locator().tick_values(*each.get_view_interval())
        assert np.isclose(ticks, place).any()
