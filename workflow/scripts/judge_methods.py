"""The failure atlas: every method on every hard scene."""

import os

# threads cost small matrices more than they save, and make their times uncertain
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.store import produce
from squealpipe.tasks.failures import judge_methods

produce(judge_methods, config={}, output=snakemake.output[0])
