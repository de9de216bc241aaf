"""The failure atlas of frequencies and stability."""

from squealpipe.paper.comparison.failures import judge_balances
from squealpipe.study.job import Job

Job(snakemake).make(judge_balances)
