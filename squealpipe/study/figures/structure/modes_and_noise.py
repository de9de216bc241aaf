"""Unstable modes of a structure, and the vibration that each grows into."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from squealpipe.plotting import squealing
from squealpipe.plotting.hysteresis import has_tracks
from squealpipe.study.figures.declared import report_figure


def _caption(answer: xr.Dataset) -> str:
    """Describe the panels that are drawn."""
    shown = squealing.with_most_contact_loss(answer).sizes["contact"]
    count = answer.sizes["contact"]
    bars = "a bar for each contact"
    if shown < count:
        bars = f"of the {shown} of {count} contacts that open most"
    told = (
        "(a) Growth rate over frequency of the complex modes, as eigenvalue codes draw it; dashed: "
        "the strongest line of each settled motion. (b) Share of the random starts that end in it, "
        "with its 95 % interval. (c) Rms speed of vibration at the contacts. (d) Share of the time "
        f"without contact, {bars}."
    )
    if not has_tracks(answer):
        return told
    told += " (e) Level of each motion as friction falls, down to where it dies (cross)"
    if "turn" in answer.sizes and np.isfinite(answer.unstable_mu.values).any():
        told += (
            "; dashed: the unstable cycle that it meets there; smaller vibrations like that one "
            "die out"
        )
    return f"{told}."


def _alt(answer: xr.Dataset) -> str:
    """Describe the panels to those who cannot see them."""
    told = (
        "Growth over frequency, and bars for each settled motion: share of starts, speed, contact "
        "loss"
    )
    return told + ("; below, speed over friction." if has_tracks(answer) else ".")


@report_figure(reads=("structure/squeal",), caption=_caption, alt=_alt)
def draw(answer: xr.Dataset) -> Figure:
    """Panels from the dataset ``structure/squeal``."""
    return squealing.figure(answer)
