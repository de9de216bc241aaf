"""The report as a page and as a PDF."""

from pathlib import Path

from squealpipe.parameters import parameters_of
from squealpipe.report.build import write_report
from squealpipe.report.content import gather, made_files, picture_files

made = snakemake.params.made
datasets, figures = made_files(made["datasets"]), made_files(made["figures"])
content = gather(
    datasets,
    figures,
    parameters_of(snakemake.params.part),
    explorer=snakemake.params.explorer,
)
write_report(
    content,
    picture_files(content, figures),
    Path(snakemake.output.page),
    Path(snakemake.output.pdf),
)
