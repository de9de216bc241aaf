"""The figures of one topic, each from the datasets that it declares."""

from squealpipe.study.figures.declared import draw
from squealpipe.study.figures.parts.style import save_figure
from squealpipe.store import load

given, params = snakemake.input, snakemake.params
datasets = {name: load(path) for name, path in zip(params.datasets, given.datasets, strict=True)}
for name in params.figures:
    save_figure(draw(name, datasets), snakemake.output[name])
