"""The model ladder: maps of the cheapest adequate model, and what choosing saves."""

from squealpipe.figures import model_ladder, model_ladder_cost
from squealpipe.figures.style import save_figure
from squealpipe.store import load

ladder = load(snakemake.input.ladder)
save_figure(model_ladder.draw(ladder), snakemake.output.maps)
save_figure(model_ladder_cost.draw(ladder), snakemake.output.cost)
