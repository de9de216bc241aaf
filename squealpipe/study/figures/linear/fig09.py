"""Fig. 9: the second natural frequency over both spring angles."""

from functools import partial

from squealpipe.study.figures.panels.frequency_map import CAPTION as KEY
from squealpipe.study.figures.panels.frequency_map import draw_mode

READS = ("natural_frequencies",)
CAPTION = (
    "Second natural frequency ω₂ of model A4 (a) in contact, Eq. (22b), and (b) separated, "
    f"Eq. (25b). {KEY}"
)
ALT = "Two maps of the second natural frequency over both spring angles, in contact and separated."
draw = partial(draw_mode, mode=2)
