"""The tiny study end to end, as a user runs it, and what the paper's figures show in its datasets.

One file, hence one test process: the other has files of its own while the study is made.
Its grids are coarse, but the scenes run to the paper study's full horizons.
"""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest

from squealpipe import plot
from squealpipe.codes import Event
from squealpipe.parameters import SCENES, Parameters
from squealpipe.store import load
from squealpipe.study.report.build import write_document
from squealpipe.study.report.content import Made, gather, picture_files
from squealpipe.study.report.sections import FIGURES

PAPER_FIGURES = [*(f"fig{number:02d}" for number in range(1, 10)), "fig10_to_12", "fig13"]


@pytest.fixture(scope="module")
def scene(tiny_study):
    return lambda name: load(tiny_study.results / f"data/simulate/{name}.nc")


def test_every_figure_of_the_paper_is_drawn_in_two_forms_and_the_report_written(tiny_study):
    for name in (f"{figure}.{suffix}" for figure in PAPER_FIGURES for suffix in ("png", "svg")):
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
    """Every number is there, and the page has at most 5,000 words."""
    data = tiny_study.results / "data"
    datasets = {
        str(path.relative_to(data).with_suffix("")): Made(path=path, rule="some")
        for path in data.rglob("*.nc")
    }
    figures = {
        name: Made(path=tiny_study.results / f"figures/{name}.png", rule="some", datasets=())
        for name in FIGURES
    }
    content = gather(datasets, figures, Parameters())
    assert set(content["figures"]) == set(FIGURES)
    page = tmp_path / "index.html"
    pictures = picture_files(content, figures)
    write_document("paper", content, pictures, page=page, pdf=tmp_path / "report.pdf")
    text = re.sub(
        r"<style>.*?</style>|<[^>]+>", " ", page.read_text(encoding="utf-8"), flags=re.DOTALL
    )
    words = text.split()
    assert len(words) <= 5000
    assert not {"None", "nan", "NaN"} & set(words)
    assert "nothing ends this" in " ".join(words)


def test_second_run_has_nothing_to_do(tiny_study, snakemake):
    again = snakemake(tiny_study.checkout, "--configfile", "workflow/config/tiny.yaml")
    assert again.returncode == 0
    assert "Nothing to be done" in again.stderr


@pytest.mark.parametrize(
    ("name", "kept"), [("F2a", True), ("F2b", True), ("F2c", True), ("F2d", False)]
)
def test_contact_is_kept_in_the_first_three_scenes_and_lost_in_the_fourth(scene, name, kept):
    run = scene(name)
    assert (float(run.normalized_contact_force.min()) > 0) == kept


def test_linear_limit_of_the_lowest_contact_force(scene):
    # K = diag(k, k) without cubic terms: lowest F/F0 = (1 − κ)/(1 + κ); λ = 15 shifts it little.
    kappa = Parameters().kappa
    lowest = [float(scene(name).normalized_contact_force.min()) for name in ("F2a", "F2b", "F2c")]
    np.testing.assert_allclose(lowest, (1 - kappa) / (1 + kappa), atol=0.08)


def test_the_two_horizontal_arrangements_are_identical(scene):
    first, second = scene("F5a"), scene("F5b")
    np.testing.assert_allclose(first.x, second.x, atol=1e-10)
    np.testing.assert_allclose(first.y, second.y, atol=1e-10)
    assert float(first.y.max()) > 2 * Parameters().preload
    assert (first.event_kind == Event.separation).sum() >= 4


def test_the_pendulum_is_pumped_past_thirty(scene):
    run = scene("F3")
    assert float(run.time[-1]) == SCENES["F3"].t_end == 500
    assert float(np.abs(run.x).max()) > 30
    early = float(np.abs(run.x).where(run.time <= 200, drop=True).max())
    assert early < float(np.abs(run.x).max())


def test_the_swing_of_fig_4_stays_below_two_lengths(scene):
    run = scene("F4")
    assert float(run.time[-1]) == 500
    largest = float(np.abs(run.x).max())
    assert 15.0 < largest < 2 * Parameters().length1


def test_as_printed_a1_and_the_linear_model_disagree_about_the_sign_and_corrected_they_agree(
    tiny_study,
):
    for folder, agree in (("", False), ("corrected/", True)):
        data = tiny_study.results / f"data/{folder}"
        run = load(data / "simulate/F2a.nc")
        static = load(data / "quasi_static_map.nc").x_static
        linear = static.sel(alpha1=np.pi / 2, alpha2=np.pi, method="nearest")
        assert (float(run.x.mean()) * float(linear) > 0) == agree


def test_the_black_region_of_fig_7_is_there_as_printed_only(tiny_study):
    for folder, there in (("", True), ("corrected/", False)):
        validity = load(tiny_study.results / f"data/{folder}validity_map.nc")
        assert bool(((validity.separates == 0) & (validity.regime_linear > 0)).any()) == there


@pytest.mark.parametrize("figure", ["F10", "F11", "F12", "F13"])
def test_branches_bend_to_lower_frequency_past_contact_loss(tiny_study, figure):
    mode = 1 if figure == "F13" else 2
    branch = load(tiny_study.results / f"data/backbone/{figure}_mode{mode}.nc")
    separated = branch.where(branch.y_peak > 1.001 * Parameters().preload, drop=True)
    assert separated.sizes["point"] > 5
    by_amplitude = separated.sortby("y_peak")
    assert float(by_amplitude.omega[-1]) < float(by_amplitude.omega[0])
    assert (np.diff(by_amplitude.omega) < 0).mean() > 0.9
