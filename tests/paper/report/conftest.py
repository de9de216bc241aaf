"""A small run: a few datasets, figures, and the report made of them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from squealpipe.brake.dynamics.assumptions import linear_pull_map
from squealpipe.brake.linear.boundaries import stability_boundaries
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from squealpipe.paper.claims.judge import judge
from squealpipe.paper.report.content import gather
from squealpipe.parameters import Parameters
from squealpipe.plotting.style import save_figure
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamped
from squealpipe.study.figures.declared import draw, reads
from squealpipe.study.report.build import write_document
from squealpipe.study.report.parts import Made, picture_files

POINTS = 21


@dataclass(frozen=True)
class SmallReport:
    """A report and what it was made of."""

    page: Path
    pdf: Path
    content: dict
    supplement: Path
    datasets: dict
    figures: dict[str, Made]


@pytest.fixture(scope="session")
def small_report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    parameters, angles = Parameters(), np.linspace(0.0, np.pi, POINTS)
    datasets = {
        "quasi_static_map": quasi_static_map(parameters, angles, angles),
        "stability_map": stability_map(parameters, angles, angles),
        "natural_frequencies": natural_frequencies(parameters, angles, angles),
        "stability_boundaries": stability_boundaries(parameters),
        "linear_pull": linear_pull_map(parameters, angles, angles),
    }
    datasets["claims"] = judge(parameters, datasets)
    made = {}
    for name, dataset in datasets.items():
        path = save(
            stamped(lambda one=dataset: one, config={}), folder / f"data/{name}.nc"
        )
        made[name] = Made(path=path, rule=f"make_{name}")
    figures = {}
    for name in ("fig01", "fig06"):
        path = folder / f"figures/{name}.png"
        save_figure(draw(name, datasets), [path])
        figures[name] = Made(path=path, rule="draw_topic", datasets=reads(name))
    page, pdf = folder / "report/index.html", folder / "report/report.pdf"
    changed = [("linear.points", 181, POINTS)]
    content = gather(made, figures, parameters, changed=changed, page=page)
    content["made"] = "supplement.html"
    pictures = picture_files(content, figures)
    write_document("paper", content, pictures, page=page, pdf=pdf)
    supplement = page.with_name("supplement.html")
    behind = {**content, "made": None}
    write_document(
        "supplement",
        behind,
        pictures,
        page=supplement,
        pdf=supplement.with_suffix(".pdf"),
    )
    return SmallReport(page, pdf, content, supplement, datasets, figures)
