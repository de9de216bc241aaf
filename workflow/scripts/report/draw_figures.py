"""The figures of one topic, each from the datasets that it declares."""

from squealpipe.plotting.style import save_figure
from squealpipe.store import load
from squealpipe.store.rerun.key import state_key
from squealpipe.study.figures.declared import draw

given, params = snakemake.input, snakemake.params
datasets = {
    name: load(path) for name, path in zip(params.datasets, given.datasets, strict=True)
}
for name in params.figures:
    save_figure(draw(name, datasets), snakemake.output[name])
for path in snakemake.output:
    state_key(path, snakemake.params.key)
