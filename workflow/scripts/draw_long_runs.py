"""Figures beyond the paper: kinds of motion, predictability, exact boundary, whirl, transient."""

from squealpipe.figures import hammering_map, predictability, refined_boundary, transient, whirl
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, out = snakemake.input, snakemake.output
hammering = load(given.hammering)
save_figure(hammering_map.draw(hammering), out.hammering)
save_figure(predictability.draw(hammering), out.predictability)
save_figure(refined_boundary.draw(load(given.refined), load(given.check)), out.refined)
save_figure(whirl.draw(load(given.run), load(given.whirl)), out.whirl)
save_figure(transient.draw(load(given.transient)), out.transient)
