"""Figs. 8 and 9: natural frequencies in both contact states, and their shift."""

from squealpipe.figures import fig08, fig09, frequency_shift
from squealpipe.figures.style import save_figure
from squealpipe.store import load

frequencies = load(snakemake.input.frequencies)
save_figure(fig08.draw(frequencies), snakemake.output.fig08)
save_figure(fig09.draw(frequencies), snakemake.output.fig09)
save_figure(frequency_shift.draw(frequencies), snakemake.output.shift)
