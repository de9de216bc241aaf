"""Verdicts of every method on every hard scene."""

from squealpipe.figures.failure_atlas import draw
from squealpipe.figures.style import save_figure
from squealpipe.store import load

save_figure(draw(load(snakemake.input.atlas)), snakemake.output)
