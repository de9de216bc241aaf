"""Convergence of harmonic balance, the paper's form of it, A1 beside A4, the atlas."""

from squealpipe.figures import a1_beside_a4, harmonic_convergence, harmonic_forms, orbit_atlas
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, output = snakemake.input, snakemake.output
save_figure(harmonic_convergence.draw(load(given.sweep)), output.sweep)
save_figure(harmonic_forms.draw(load(given.forms)), output.forms)
save_figure(a1_beside_a4.draw(load(given.beside)), output.beside)
save_figure(orbit_atlas.draw(load(given.atlas)), output.atlas)
