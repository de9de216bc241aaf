"""Work–precision of harmonic balance on A4 and of eigenvalues near flutter onset."""

import os

# threads cost small matrices more than they save, and make their times uncertain
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.comparison.work_precision import harmonic as speed_accuracy_harmonic, stability as speed_accuracy_stability
from squealpipe.tasks.comparison.work_precision.solutions import work_precision

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
produce(
    lambda: work_precision(
        [
            *speed_accuracy_harmonic.solutions(params, **part["comparison.harmonic"]),
            *speed_accuracy_stability.solutions(**part["comparison.onset"]),
        ]
    ),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
