"""The figures of one topic, each from the datasets that it declares."""

from squealpipe.plotting.style import save_figure
from squealpipe.store import load
from squealpipe.study.figures.declared import draw
from squealpipe.study.job import Job

given, params = snakemake.input, snakemake.params
datasets = {
    name: load(path) for name, path in zip(params.datasets, given.datasets, strict=True)
}
for name in params.figures:
    save_figure(draw(name, datasets), snakemake.output[name])
Job(snakemake).state_keys()
