"""The report as a page and as a PDF."""

from pathlib import Path

from squealpipe.parameters import parameters_of
from squealpipe.study.report.build import write_report
from squealpipe.study.report.content import gather, made_files, picture_files

datasets, figures = made_files(snakemake.params.made), made_files(snakemake.params.drawn)
content = gather(
    datasets,
    figures,
    parameters_of(snakemake.params.part),
    beyond_paper=snakemake.params.beyond_paper,
    explorer=snakemake.params.explorer,
    animations=snakemake.params.animations,
    page=Path(snakemake.output.page),
)
write_report(
    content,
    picture_files(content, figures),
    Path(snakemake.output.page),
    Path(snakemake.output.pdf),
)
