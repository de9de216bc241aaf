"""Error against cost, for every kind of task."""

from squealpipe.figures import (
    work_precision_evaluations,
    work_precision_frequencies,
    work_precision_time,
    work_precision_validity,
)
from squealpipe.figures.style import save_figure
from squealpipe.store import load

integration = load(snakemake.input.integration)
frequencies = load(snakemake.input.frequencies)
save_figure(work_precision_time.draw(integration), snakemake.output.time)
save_figure(work_precision_evaluations.draw(integration), snakemake.output.evaluations)
save_figure(work_precision_validity.draw(integration), snakemake.output.validity)
save_figure(work_precision_frequencies.draw(frequencies), snakemake.output.frequencies)
