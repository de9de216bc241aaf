"""The parameters that agree with the paper's statements."""

from squealpipe.figures.parameter_inference import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

save_figure(draw(load(snakemake.input.inference)), snakemake.output)
