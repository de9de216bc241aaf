"""The failure atlas of frequencies and stability."""

from squealpipe.execution.job import Job
from squealpipe.tasks.comparison.failures import judge_balances

Job(snakemake).make(judge_balances)
