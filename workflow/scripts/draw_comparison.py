"""Error against cost for every kind of task, the failure atlas, and the model ladder."""

from squealpipe.figures import (
    failure_atlas,
    model_ladder,
    model_ladder_cost,
    work_precision_evaluations,
    work_precision_frequencies,
    work_precision_time,
    work_precision_validity,
)
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, made = snakemake.input, snakemake.output
integration, frequencies = load(given.integration), load(given.frequencies)
atlas, ladder = load(given.atlas), load(given.ladder)
save_figure(work_precision_time.draw(integration), made.work_precision_time)
save_figure(work_precision_evaluations.draw(integration), made.work_precision_evaluations)
save_figure(work_precision_validity.draw(integration), made.work_precision_validity)
save_figure(work_precision_frequencies.draw(frequencies), made.work_precision_frequencies)
save_figure(failure_atlas.draw(atlas), made.failure_atlas)
save_figure(model_ladder.draw(ladder), made.model_ladder)
save_figure(model_ladder_cost.draw(ladder), made.model_ladder_cost)
