"""The explorer page."""

from squealpipe.store import load
from squealpipe.study.job import Job
from squealpipe.study.report.explorer import write_explorer
from squealpipe.study.report.explorer.layers import layers

settings, maps = snakemake.params.settings, snakemake.params.maps
write_explorer(
    load(snakemake.input.explorer),
    layers(**{name: load(snakemake.input[name]) for name in maps}),
    snakemake.output[0],
    settings["scenes"],
    paper=settings["paper"],
)
Job(snakemake).state_keys()
