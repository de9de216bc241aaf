"""Fig. 6: quasi-static sliding and linear stability."""

from squealpipe.figures.fig06 import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given = snakemake.input
save_figure(
    draw(load(given.stability), load(given.quasi_static), load(given.boundaries)), snakemake.output
)
