"""Fig. 8: the first natural frequency over both spring angles."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squealpipe.figures.frequency_map import draw_mode

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

CAPTION = (
    "First natural frequency ω₁ of model A4 (a) in contact, Eq. (22a), where it vanishes around "
    "α₁ = α₂ = π/2, and (b) separated, Eq. (25a), where it vanishes along α₁ + α₂ = nπ and is "
    "largest along α₁ + α₂ = nπ/2, n odd. Hatched: flutter, a complex pair, of which the common "
    "frequency is shown."
)
ALT = "Two maps of the first natural frequency over both spring angles, in contact and separated."


def draw(frequencies: xr.Dataset) -> Figure:
    """Both states of mode 1, from dataset ``natural_frequencies``."""
    return draw_mode(frequencies, 1)
