"""Fig. 7: where the linear analysis is valid."""

from squealpipe.figures.fig07 import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

save_figure(draw(load(snakemake.input.validity)), snakemake.output)
