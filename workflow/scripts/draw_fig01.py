"""Fig. 1: the mechanism."""

from squealpipe.figures.fig01 import draw
from squealpipe.figures.style import save_figure

save_figure(draw(), snakemake.output)
