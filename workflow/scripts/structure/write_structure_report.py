"""The report of a structure, as a page and as a PDF, and its provenance."""

import json
from pathlib import Path

from squealpipe.store.keys import refuse_misfits
from squealpipe.store.whole_files import whole_file
from squealpipe.study.job import Job
from squealpipe.study.report.build import write_document
from squealpipe.study.report.parts import made_files, picture_files, provenance
from squealpipe.study.report.structure import gather_structure, media_of_structure

params, out = snakemake.params, snakemake.output
refuse_misfits(params.expected)
datasets, figures = made_files(params.made), made_files(params.drawn)
content = gather_structure(datasets, figures)
pictures = picture_files(content, figures)
write_document(
    "structure",
    content,
    pictures,
    page=Path(out.page),
    pdf=Path(out.pdf),
    media=media_of_structure(datasets),
)
with whole_file(Path(out.provenance)) as temporary:
    temporary.write_text(
        json.dumps(provenance(datasets, figures), indent=1), encoding="utf-8"
    )
Job(snakemake).state_keys()
