"""The failure atlas of frequencies and stability."""

import os

# threads cost small matrices more than they save
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.store import produce
from squealpipe.tasks.comparison.failures import judge_balances

produce(judge_balances, config=snakemake.params.part, key=snakemake.params.key, output=snakemake.output[0])
