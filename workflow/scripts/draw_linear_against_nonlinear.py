"""What A3 predicts against what A1 does."""

from squealpipe.figures.linear_against_nonlinear import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

save_figure(draw(load(snakemake.input.validity)), snakemake.output)
