"""The explorer page."""

from squealpipe.store import load
from squealpipe.store.rerun.key import state_key
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
for path in snakemake.output:
    state_key(path, snakemake.params.key)
