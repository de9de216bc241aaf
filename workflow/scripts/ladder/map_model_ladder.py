"""The cheapest adequate model over both spring angles."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.ladder.ladder import model_ladder

part = snakemake.params.part
params, ladder = for_linear(parameters_of(part), part["read_as"]), part["comparison.ladder"]
produce(
    lambda: model_ladder(
        params,
        ladder["points"],
        ladder["tolerance"],
        t_end=ladder["horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
