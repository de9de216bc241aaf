"""Work–precision of harmonic balance on A4."""

import os

# threads cost small matrices more than they save, and make their times uncertain
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.comparison.work_precision import work_precision

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
produce(
    lambda: work_precision(params, **part["comparison.harmonic"]),
    config=part, key=snakemake.params.key, output=snakemake.output[0],
)
