"""Work–precision of the time integration of A1 and of the validity map."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.comparison.work_precision import integration as speed_accuracy_integration, validity as speed_accuracy_validity
from squealpipe.tasks.comparison.work_precision.solutions import work_precision

part = snakemake.params.part
study = part["comparison.integration"]
maps = part["comparison.validity"]
params = for_linear(parameters_of(part), part["read_as"])
produce(
    lambda: work_precision(
        [
            *speed_accuracy_integration.solutions(params, **study),
            *speed_accuracy_validity.solutions(params, **maps),
        ]
    ),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
