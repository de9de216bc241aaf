"""Figures beside the paper's: the plane of Z, frequency shifts, areas, published model."""

from squealpipe.figures import frequency_shift, linear_shares, mode_coupling, stability_plane
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, out = snakemake.input, snakemake.output
save_figure(stability_plane.draw(load(given.boundaries)), out.plane)
save_figure(frequency_shift.draw(load(given.frequencies)), out.shift)
save_figure(linear_shares.draw(load(given.shares)), out.shares)
save_figure(mode_coupling.draw(load(given.coupling)), out.coupling)
