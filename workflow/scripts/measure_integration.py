"""Work–precision of the time integration of A1 and of the validity map."""

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks import speed_accuracy_integration, speed_accuracy_validity
from squealpipe.tasks.work_precision import work_precision

part = snakemake.params.part
study = part["comparison.integration"]
maps = part["comparison.validity"]
params = parameters_of(part)
produce(
    lambda: work_precision(
        [
            *speed_accuracy_integration.solutions(params, **study),
            *speed_accuracy_validity.solutions(params, **maps),
        ]
    ),
    config=part,
    output=snakemake.output[0],
)
