"""The verdict on every statement of the paper."""

from squealpipe.study.claims.judge import judge
from squealpipe.parameters import parameters_of
from squealpipe.store import produce

part, paths = snakemake.params.part, snakemake.input.datasets
sources = dict(zip(snakemake.params.names, paths, strict=True))
produce(
    lambda: judge(parameters_of(part), sources, part["reading"]),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
    inputs=paths,
)
