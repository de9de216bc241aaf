"""Fig. 6, and beside it the plane of Z, the areas of the regimes and a published model."""

from squealpipe.figures import fig06, linear_shares, mode_coupling, stability_plane, static_state
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, out = snakemake.input, snakemake.output
boundaries, quasi_static = load(given.boundaries), load(given.quasi_static)
save_figure(fig06.draw(load(given.stability), quasi_static, boundaries), out.fig06)
save_figure(static_state.draw(quasi_static), out.static)
save_figure(stability_plane.draw(boundaries), out.plane)
save_figure(linear_shares.draw(load(given.shares)), out.shares)
save_figure(mode_coupling.draw(load(given.coupling)), out.coupling)
