"""Fig. 8: the first natural frequency over both spring angles."""

from functools import partial

from squealpipe.study.figures.panels.frequency_map import CAPTION as KEY
from squealpipe.study.figures.panels.frequency_map import draw_mode

READS = ("natural_frequencies",)
CAPTION = (
    "First natural frequency ω₁ of model A4 (a) in contact, Eq. (22a), and (b) separated, "
    f"Eq. (25a). {KEY}"
)
ALT = "Two maps of the first natural frequency over both spring angles, in contact and separated."
draw = partial(draw_mode, mode=1)
