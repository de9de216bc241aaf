"""The failure atlas: every method on every hard scene."""

from squealpipe.store import produce
from squealpipe.tasks.failures import judge_methods

produce(judge_methods, config={}, output=snakemake.output[0])
