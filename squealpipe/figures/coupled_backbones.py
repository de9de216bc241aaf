"""Backbones of coupled scenes, where both modes move in x and y and lose contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.backbone_panels import KEY, draw_branch, key_entries
from squealpipe.figures.style import PAGE, new_figure, panel_letter, pi_label

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Periodic motions of model A4 where x and y are coupled (K₁₂ ≠ 0): both modes lose contact "
    "and bend to lower frequencies. Dotted stretches lie between period doublings. " + KEY
)
ALT = "Panels of amplitude over frequency for both modes of two coupled spring arrangements."


def draw(scenes: Mapping[str, Sequence[Sequence[xr.Dataset]]], preload: float) -> Figure:
    """A row a scene, a panel a mode; each entry as for ``backbone_panels.draw_scene``."""
    figure, axes = new_figure(PAGE, 0.6 + 2.5 * len(scenes), nrows=len(scenes), ncols=2)
    letters = iter("abcdefghijklmnopqrst")
    for row, branches in zip(axes, scenes.values(), strict=True):
        for panel, number, (exact, series) in zip(row, "₁₂", branches, strict=True):
            draw_branch(panel, exact, series, preload)
            angles = ", ".join(pi_label(float(exact.attrs[name])) for name in ("alpha1", "alpha2"))
            panel_letter(panel, next(letters), f"({angles}), vicinity of ω{number}")
        row[0].set_ylabel("amplitude (m)")
    handles, labels = key_entries(axes.ravel())
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure
