"""The failure atlas: every method on every hard scene."""

import os

# threads cost small matrices more than they save
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.store import produce
from squealpipe.tasks.comparison.failures.atlas import judge_methods

part = snakemake.params.part
produce(
    lambda: judge_methods(**part["comparison.atlas"]), config=part, key=snakemake.params.key, output=snakemake.output[0]
)
