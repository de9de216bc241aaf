"""Fig. 9: the second natural frequency over both spring angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.frequency_map import draw_mode

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "Second natural frequency ω₂ of model A4 (a) in contact, Eq. (22b), and (b) separated, "
    "Eq. (25b), where it is largest along the lines α₁ + α₂ = nπ on which ω₁ vanishes. Hatched: "
    "flutter, a complex pair, of which the common frequency is shown."
)
ALT = "Two maps of the second natural frequency over both spring angles, in contact and separated."


def draw(frequencies: xr.Dataset) -> Figure:
    """Both states of mode 2, from dataset ``natural_frequencies``."""
    return draw_mode(frequencies, 2)
