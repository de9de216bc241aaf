"""The failure atlas of frequencies and stability."""

import os

# threads cost small matrices more than they save
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from squealpipe.execution.job import Job
from squealpipe.tasks.comparison.failures import judge_balances

Job(snakemake).make(judge_balances)
