"""The tiny study end to end, as a user runs it, with the verdicts that its datasets give.

One file, hence one test process: the other has files of its own while the study is made.
Its grids are coarse, but the scenes run to the paper study's full horizons.
"""

import re

import matplotlib.pyplot as plt

from squealpipe import plot
from squealpipe.paper.report.content import gather
from squealpipe.paper.report.sections import PAPER_FIGURES as FIGURES
from squealpipe.parameters import Parameters
from squealpipe.store import load, save
from squealpipe.study.report.build import write_document
from squealpipe.study.report.parts import Made, picture_files

PAPER_FIGURES = [
    *(f"fig{number:02d}" for number in range(1, 10)),
    "fig10_to_12",
    "fig13",
]


def test_every_figure_of_the_paper_is_drawn_in_two_forms_and_the_report_written(
    tiny_study,
):
    for name in (
        f"{figure}.{suffix}" for figure in PAPER_FIGURES for suffix in ("png", "svg")
    ):
        assert (tiny_study.results / "figures" / name).stat().st_size > 2000
    for name in ("index", "supplement"):
        text = (tiny_study.results / f"report/{name}.html").read_text(encoding="utf-8")
        assert "</html>" in text


def test_a_picture_for_every_kind_of_dataset(tiny_study):
    drawn = set()
    for path in sorted((tiny_study.results / "data").rglob("*.nc")):
        dataset = load(path)
        if dataset.attrs["schema"] in drawn:
            continue
        drawn.add(dataset.attrs["schema"])
        ax = plot(dataset)
        assert ax.has_data() or ax.texts, path
        plt.close("all")
    assert len(drawn) > 25


def test_narrative_of_the_shipped_study_fits_its_datasets(tiny_study, tmp_path):
    """Every number is there, and the page has at most 6,000 words, its tables among them."""
    data = tiny_study.results / "data"
    datasets = {
        str(path.relative_to(data).with_suffix("")): Made(path=path, rule="some")
        for path in data.rglob("*.nc")
    }
    figures = {
        name: Made(
            path=tiny_study.results / f"figures/{name}.png", rule="some", datasets=()
        )
        for name in FIGURES
    }
    # its words are about pads on four and eight points, which take a minute
    pads = load(datasets["contact_points"].path).assign_coords(design=["4", "8"])
    numbers = [name for name, each in pads.data_vars.items() if each.dtype.kind == "f"]
    pads.update(pads[numbers].fillna(0.3))
    longer = save(pads, tmp_path / "contact_points.nc")
    datasets["contact_points"] = Made(path=longer, rule="some")
    content = gather(datasets, figures, Parameters())
    assert set(content["figures"]) == set(FIGURES)
    page = tmp_path / "index.html"
    pictures = picture_files(content, figures)
    write_document("paper", content, pictures, page=page, pdf=tmp_path / "report.pdf")
    text = re.sub(
        r"<style>.*?</style>|<[^>]+>",
        " ",
        page.read_text(encoding="utf-8"),
        flags=re.DOTALL,
    )
    words = text.split()
    assert len(words) <= 6000
    assert not {"None", "nan", "NaN"} & set(words)
    assert "nothing ends this" in " ".join(words)


def test_second_run_has_nothing_to_do(tiny_study, snakemake):
    again = snakemake(tiny_study.checkout, "--configfile", "workflow/config/tiny.yaml")
    assert again.returncode == 0
    assert "Nothing to be done" in again.stderr


def test_verdicts_are_those_recorded_where_the_grids_are_fine_enough(tiny_study):
    claims = load(tiny_study.results / "data/claims.nc")
    differing = claims.claim.values[(claims.verdict_here != claims.recorded).values]
    assert set(differing) <= {"F7b", "E9", "E10"}
