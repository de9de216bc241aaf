"""Charts of regimes: what a design is next to, over both angles, and over κ and μ."""

import json
from collections.abc import Iterable, Mapping
from string import ascii_lowercase
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.brake.schema.curves import ChartLine
from squealpipe.paper.figures.linear.fig07 import CELL_KINDS
from squealpipe.parameters import SCENES
from squealpipe.plotting import style
from squealpipe.plotting.cycles import key_entries
from squealpipe.plotting.origin import scene_title, time_unit
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number

LINE_LOOKS: dict[ChartLine, tuple[str, dict[str, Any]]] = {
    ChartLine.contact_lost: ("contact is lost", {"color": style.Colour.black}),
    ChartLine.flutter: ("A3 flutters", {"color": style.Colour.blue, "linestyle": "--"}),
    ChartLine.divergence: (
        "A3 diverges",
        {"color": style.Colour.green, "linestyle": ":"},
    ),
    ChartLine.whirl: (
        "the whirl is born",
        {"color": style.Colour.red, "linestyle": "-."},
    ),
    ChartLine.stick: ("its stick begins", {"color": style.Colour.purple}),
}


def caption(angles: xr.Dataset, scenes: Mapping[str, xr.Dataset]) -> str:
    """Explain the lines that are drawn."""
    horizon = number(float(angles.t_end) / time_unit(angles))
    known = _known(angles, scenes)
    dashpots = json.loads(angles.attrs["config"]).get("cycles.damping", 0.0)
    cycles = (
        "The whirl, a fast cycle around the fixed ends of the springs, is that of A1 with dashpots "
        f"of {number(dashpots)} √(k1 m): it is born in a fold. "
    )
    return (
        "Charts of regimes: where A1, from rest, loses contact up to t = "
        f"{horizon} √(m/k1), and where A3 without damping flutters and diverges, as curves. "
        "(a) Over both spring angles, with the scenes as crosses; then over κ = k₃/k₁ and μ at the "
        "angles of scenes, with the study's own values as a cross. "
        f"{cycles if ChartLine.whirl in known else ''}"
    ).strip()


def distances(
    angles: xr.Dataset, scenes: Mapping[str, xr.Dataset]
) -> dict[str, list[Any]]:
    """Table of how far each scene is from the nearest line of each kind: columns and rows."""
    known = _known(angles, scenes)
    rows = []
    for index, name in enumerate(sorted(scenes)):
        of_angles = _listed(known, angles, index, np.degrees(1.0))
        rows.append([f"{_title(name)}: angles (°)", *of_angles])
        rows.append([f"{_title(name)}: (κ, μ)", *_listed(known, scenes[name], 0, 1.0)])
    return {
        "columns": ["Scene", *(LINE_LOOKS[which][0] for which in known)],
        "rows": rows,
    }


def _known(angles: xr.Dataset, scenes: Mapping[str, xr.Dataset]) -> list[ChartLine]:
    charts = [angles, *scenes.values()]
    return [
        which
        for which in LINE_LOOKS
        if any(which.name in chart.boundary for chart in charts)
    ]


@report_figure(
    reads=("angle_chart", "friction_chart/*"),
    caption=caption,
    alt="Charts over both angles and over κ and μ with lines, regions, and crosses at the scenes.",
)
def draw(angles: xr.Dataset, scenes: Mapping[str, xr.Dataset]) -> Figure:
    """One panel for each chart."""
    names = sorted(scenes)
    rows = (len(names) + 2) // 2
    figure, axes = style.new_figure(style.PAGE, 0.8 + 2.6 * rows, ncols=2, nrows=rows)
    panels = axes.ravel()
    _draw(panels[0], angles)
    for axis in (panels[0].xaxis, panels[0].yaxis):
        style.angle_ticks(axis)
    panels[0].set(xlabel="α₁ (rad)", ylabel="α₂ (rad)")
    style.panel_letter(panels[0], "a", "both angles")
    for name, at in zip(names, angles.design.values, strict=True):
        left = at[0] < float(angles.range[0].mean())
        panels[0].annotate(
            _title(name).rpartition(", ")[2],
            at,
            (-5 if left else 5, 5),
            textcoords="offset points",
            ha="right" if left else "left",
            color=style.Colour.red,
            path_effects=style.white_halo,
        )
    for panel, letter, name in zip(
        panels[1:], ascii_lowercase[1:], names, strict=False
    ):
        _draw(panel, scenes[name])
        panel.set(xlabel="κ", ylabel="μ")
        style.panel_letter(panel, letter, _title(name))
    for panel in panels[1 + len(names) :]:
        panel.remove()
    handles, _ = key_entries(panels[: 1 + len(names)])
    charts = [angles, *scenes.values()]
    # a region of less than 0.1 % of the chart is not visible in print
    shown = [
        max((_kinds(chart) == k).mean() for chart in charts) > 1e-3
        for k in range(len(CELL_KINDS))
    ]
    tones = style.patches(
        kind for kind, there in zip(CELL_KINDS, shown, strict=True) if there
    )
    figure.legend(handles=[*tones, *handles], loc="outside lower center", ncols=3)
    return figure


def _kinds(chart: xr.Dataset) -> np.ndarray:
    return np.asarray(2 * chart.cell_kept.values + (chart.cell_regime.values > 0))


def _draw(panel: Axes, chart: xr.Dataset) -> None:
    x, y = (chart[str(name)].values for name in chart.parameter.values)
    tones = style.category_colours([tone for tone, _ in CELL_KINDS])
    extent = chart.range.values.ravel()
    panel.imshow(
        _kinds(chart).T, origin="lower", extent=extent, interpolation="none", **tones
    )
    for which, (label, look) in LINE_LOOKS.items():
        on = chart.line.values == which
        if which.name not in chart.boundary.values:
            continue
        style.draw_lines(
            panel, (x[on], y[on]), chart.curve.values[on], label=label, **look
        )
    look = {
        "color": style.Colour.red,
        "ms": 7,
        "mew": 1.8,
        "path_effects": style.white_halo,
    }
    panel.plot(*chart.design.values.T, "x", label="scene", **look)
    panel.set(xlim=extent[:2], ylim=extent[2:], aspect="auto", box_aspect=1)


def _title(name: str) -> str:
    scene = name.rpartition("/")[2]
    return scene_title(scene) if scene in SCENES else scene


def _listed(
    known: Iterable[ChartLine], chart: xr.Dataset, place: int, unit: float
) -> list[str]:
    by_line = dict(
        zip(chart.boundary.values, unit * chart.distance.values[place], strict=True)
    )
    values = (by_line.get(which.name, np.inf) for which in known)
    return [number(far, 3) if np.isfinite(far) else "none" for far in values]
