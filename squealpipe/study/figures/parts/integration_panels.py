"""Four panels, one for each scene, of the time integration's work–precision."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting.style import PAGE, new_figure, panel_letter
from squealpipe.study.figures.parts.work_precision import draw_methods, foot, legend_above


def draw_scenes(dataset: xr.Dataset, cost: str, scale: float, label: str) -> Figure:
    """One panel for each scene of the task ``integration``.

    Args:
        dataset: ``work_precision``.
        cost, scale, label: variable of the y axes, its factor and its name.
    """
    rows = dataset.isel(run=dataset.task.values == "integration")
    scenes = list(dict.fromkeys(rows.scene.values.tolist()))
    figure, axes = new_figure(PAGE, 5.6, nrows=2, ncols=2, sharex=True, sharey=True)
    for letter, panel, scene in zip("abcd", axes.flat, scenes, strict=False):
        draw_methods(panel, rows.isel(run=rows.scene.values == scene), cost, scale)
        panel_letter(panel, letter, scene)
    for panel in axes[-1]:
        panel.set_xlabel("error of the final state")
    for panel in axes[:, 0]:
        panel.set_ylabel(label)
    legend_above(figure, axes[0, 0], 4)
    foot(figure, dataset)
    return figure
