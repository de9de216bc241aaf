"""The report of a study of one's own, as a page and as a PDF, and its provenance."""

import json
from pathlib import Path

from squealpipe.parameters import parameters_of
from squealpipe.store import load
from squealpipe.store.keys import refuse_misfits
from squealpipe.store.whole_files import whole_file
from squealpipe.study.job import Job
from squealpipe.study.report.build import write_document
from squealpipe.study.report.own import gather_own, media_of_scenes
from squealpipe.study.report.parts import made_files, picture_files, provenance
from squealpipe.study.report.tables import write_tables

params, out = snakemake.params, snakemake.output
refuse_misfits(params.expected)
datasets, figures = made_files(params.made), made_files(params.drawn)
made_how = provenance(datasets, figures)
content = gather_own(
    datasets,
    figures,
    parameters_of(params.settings),
    [row for row in params.changed if row[0] in made_how["configuration"]],
    params.left_out,
    params.became,
)
pictures = picture_files(content, figures)
write_document(
    "study",
    content,
    pictures,
    page=Path(out.page),
    pdf=Path(out.pdf),
    media=media_of_scenes(datasets),
)
write_tables(
    {
        name.removeprefix("assess/"): load(made.path)
        for name, made in datasets.items()
        if name.startswith("assess/")
    },
    parameters_of(params.settings),
    Path(out.tables),
)
with whole_file(Path(out.provenance)) as temporary:
    temporary.write_text(json.dumps(made_how, indent=1), encoding="utf-8")
Job(snakemake).state_keys()
