"""The paper's report and its supplement, each as a page and as a PDF, and the provenance."""

import json
from pathlib import Path

from squealpipe.paper.report.content import gather
from squealpipe.parameters import parameters_of
from squealpipe.store.keys import refuse_misfits
from squealpipe.store.whole_files import whole_file
from squealpipe.study.job import Job
from squealpipe.study.report.build import write_document
from squealpipe.study.report.parts import made_files, picture_files, provenance

params, out = snakemake.params, snakemake.output
refuse_misfits(params.expected)
datasets, figures = made_files(params.made), made_files(params.drawn)
content = gather(
    datasets,
    figures,
    parameters_of(params.settings),
    reading=params.settings["reading"],
    changed=params.changed,
    links=params.links,
    page=Path(out.page),
)
pictures = picture_files(content, figures)
supplement = {**content, "title": "Methods, accuracy and failures", "made": None}
content["made"] = Path(out.supplement).name
write_document("paper", content, pictures, page=Path(out.page), pdf=Path(out.pdf))
write_document(
    "supplement",
    supplement,
    pictures,
    page=Path(out.supplement),
    pdf=Path(out.supplement_pdf),
)
with whole_file(Path(out.provenance)) as temporary:
    temporary.write_text(
        json.dumps(provenance(datasets, figures), indent=1), encoding="utf-8"
    )
Job(snakemake).state_keys()
