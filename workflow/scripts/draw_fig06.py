"""Fig. 6: quasi-static sliding and linear stability."""

from squealpipe.figures.fig06 import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

save_figure(draw(load(snakemake.input.stability)), snakemake.output)
