"""The report of a study of one's own, with the numbers of a real pad."""

import math
import re
import resource
from dataclasses import replace

import numpy as np
import pytest
from openpyxl import load_workbook

from squealpipe import assess
from squealpipe.brake.assess.map import verdict_map
from squealpipe.brake.assess.shares import verdict_shares
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.propensity.distributions import centred
from squealpipe.cli import run
from squealpipe.codes import Verdict
from squealpipe.parameters import Parameters
from squealpipe.plotting.style import save_figure
from squealpipe.store import load
from squealpipe.store.mistakes import ConfigError
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamped
from squealpipe.store.whole_files import StoreError
from squealpipe.study.configuration.settings import PAPER, parse_study, read_study
from squealpipe.study.figures.declared import draw, reads
from squealpipe.study.report import answer
from squealpipe.study.report.build import write_document
from squealpipe.study.report.own import gather_own, scene
from squealpipe.study.report.parts import Made, parameter_table, picture_files
from squealpipe.study.report.tables import write_tables
from tests.conftest import ROOT

PAD = Parameters(
    mass=0.5,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    mu=0.4,
    belt_speed=2.0,
    preload=2e-5,
    length1=0.02,
    length2=0.02,
)
REST = {"x": 0.0, "y": 0.0, "vx": 0.0, "vy": 0.0}


def scenes(speed):
    angles = {"alpha1": math.radians(30), "alpha2": math.radians(140), "t_end": 40.0}
    return {
        "mine": {**angles, "start": {**REST, "vx": speed}},
        "rest": {**angles, "start": REST},
    }


def test_distributions_are_centred_on_the_study():
    given = centred(PAD, 0.5, 2.4)
    assert given["k1"]["mean"] == PAD.k1
    assert given["k3"]["median"] == PAD.k3
    assert (given["mu"]["low"], given["mu"]["high"]) == pytest.approx((0.4 / 3, 1.2))
    assert given["alpha2"]["mean"] == 2.4


def of_a_push(by_cure, *_, **__):
    """Cures that end every start where they end that of a push."""
    return {
        name: each._replace(quiet_from_any_start=each.quiet_from, is_run=True)
        for name, each in by_cure.items()
    }


@pytest.fixture(scope="module")
def answers():
    mine = scenes(0.0)["mine"]
    with pytest.MonkeyPatch.context() as patch:
        # a report does not ask how they were found, which takes most of the time
        patch.setattr("squealpipe.vibration.cures.of_any_start", of_a_push)
        told = assess(PAD, mine["alpha1"], mine["alpha2"], tol=1e-7)
    return dict.fromkeys(scenes(0.0), told)


@pytest.fixture(scope="module")
def made_and_figures(answers, tmp_path_factory):
    """The datasets of a study, in files, and its pictures."""
    folder = tmp_path_factory.mktemp("own")
    angles = np.linspace(0.0, math.pi, 3)
    datasets = {
        "verdict_map": verdict_map(PAD, angles, angles, workers=1),
        **{f"assess/{name}": answer for name, answer in answers.items()},
        **{
            f"own/{name}": simulate(
                PAD, each["alpha1"], each["alpha2"], t_end=20 * PAD.time_unit
            )
            for name, each in scenes(0.0).items()
        },
    }
    made, figures = {}, {}
    for name, dataset in datasets.items():
        made[name] = saved(dataset, folder / f"data/{name}.nc")
        datasets[name] = load(made[name].path)
    for name in ("own_settled", "own_phases", "own_map", "own_model", "own_motion"):
        path = folder / f"{name}.png"
        save_figure(draw(name, datasets), [path])
        figures[name] = Made(path=path, rule="some", datasets=reads(name))
    return made, figures


def saved(dataset, path):
    """A dataset of the study, in a file."""
    config = {"parameters": PAD.as_dict()}
    return Made(path=save(stamped(lambda: dataset, config=config), path), rule="some")


def words_of(page):
    text = page.read_text(encoding="utf-8")
    return " ".join(
        re.sub(r"<style>.*?</style>|<[^>]+>", " ", text, flags=re.DOTALL).split()
    )


def test_report_begins_with_the_answer_and_has_no_paper(
    answers, made_and_figures, tmp_path
):
    made, figures = made_and_figures
    content = gather_own(
        made,
        figures,
        PAD,
        [("dynamics.hammering_points", 91, 5)],
        ["this part"],
        ["preload_force = 4 kN: preload = 0.5714 mm"],
    )
    page = tmp_path / "index.html"
    write_document(
        "study",
        content,
        picture_files(content, figures),
        page=page,
        pdf=tmp_path / "report.pdf",
    )
    words = words_of(page)
    for absent in ("paper", "Fig.", "None", " nan", "rad/s", "κ"):
        assert absent not in words
    told = list(answer.lines(answers["mine"]))
    for present in (
        *told[:5],
        "mine",
        "What changes it",
        "this part",
        "preload_force = 4 kN: preload = 0.5714 mm",
        "dynamics.hammering_points 91 5",
    ):
        assert present in words
    assert words.index(told[0]) < words.rindex("What changes it")
    assert "With scattered parameters" not in words
    assert page.read_text(encoding="utf-8").count("<img") == len(figures)


def test_a_full_disk_of_temporary_files_is_told_with_its_folder(tmp_path):
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, usual[1]))
    page, pdf = tmp_path / "index.html", tmp_path / "report.pdf"
    try:
        with pytest.raises(
            StoreError, match=r"cannot write .*report-.*File too large; free space"
        ):
            write_document("study", {"title": 200 * "a"}, {}, page=page, pdf=pdf)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert not any(tmp_path.iterdir())


def test_scatter_is_told_where_it_is_configured(made_and_figures, tmp_path):
    spread = {"mu": {"distribution": "uniform", "low": 0.1, "high": 0.7}}
    angles = [scenes(0.0)["mine"][name] for name in ("alpha1", "alpha2")]
    shares = verdict_shares(PAD, *angles, distributions=spread, samples=16)
    assert float(shares.share.sum()) == pytest.approx(1.0)
    made, figures = made_and_figures
    made = made | {"verdict_shares": saved(shares, tmp_path / "shares.nc")}
    scatter = gather_own(made, figures, PAD)["scatter"]
    assert scatter["samples"] == 16
    assert scatter["distributions"] == [
        {"name": "mu", "words": "uniform, low 0.1, high 0.7"}
    ]


def test_tables_hold_the_numbers_of_the_answer(answers, tmp_path):
    write_tables(answers, PAD, tmp_path / "tables.xlsx")
    book = load_workbook(tmp_path / "tables.xlsx")
    assert book.sheetnames[:3] == ["Answer", "What stops it", "Parameters"]
    rows = {row[0].value: row[2].value for row in book["Answer"].iter_rows(min_row=2)}
    told = answers["mine"]
    long_name = told.velocity_rms_across.attrs["long_name"]
    assert rows[long_name] == pytest.approx(float(told.velocity_rms_across))
    assert rows["in words"] == answer.headline(told)
    cures = [
        (row[1].value, row[4].value)
        for row in book["What stops it"].iter_rows(min_row=2)
        if row[0].value == "mine"
    ]
    for words, value in cures:
        name = next(key for key, each in answer.NAMES.items() if each == words)
        expected = float(told.quiet_from.sel(cure=name))
        if name.startswith("alpha"):
            expected = math.degrees(expected)
        assert (value is None) == math.isnan(expected)
        if value is not None:
            assert value == pytest.approx(expected)
    assert book["Parameters"]["C2"].value == PAD.mass


def test_a_cure_of_nothing_is_told_in_points_and_no_friction_by_its_name(answers):
    told = answers["mine"].copy(deep=True)
    for name, value, quiet_from, change in (
        ("damping", 0.0, 0.083, 8.3),
        ("mu", 0.4, 1e-5, -100.0),
    ):
        for key, number in (
            ("value", value),
            ("quiet_from", quiet_from),
            ("change", change),
        ):
            told[key].loc[{"cure": name}] = number
    words = {cure.name: cure for cure in answer.cures(told)}
    assert words["damping"].now == "0 %"
    assert words["damping"].change == "+8.3 points"
    assert words["mu"].quiet_from == "practically no friction"


def test_sliding_far_from_rest_is_told_with_its_distance(answers):
    told = answers["mine"].copy(deep=True)
    near = answer.cause(told)
    assert "times the preload" not in near
    for name, preloads in (("x_sliding", -60.0), ("y_sliding", -11.0)):
        told[name] = preloads * told.preload
    far = answer.cause(told)
    assert far.startswith(near)
    assert "61 times the preload" in far
    assert far in answer.lines(told)


def test_what_is_quiet_unless_struck_names_only_starts_that_last(answers):
    told = answers["mine"].copy(deep=True)
    told["verdict"], told["quiet_unless_struck"] = Verdict.quiet, True
    for sudden, named in ((Verdict.hammers, True), (Verdict.quiet, False)):
        told["sudden_verdict"] = sudden
        assert ("a sudden start" in answer.headline(told)) == named
    told.quiet_from.loc[{"cure": "mu"}] = np.nan
    told.quiet_from_any_start.loc[{"cure": "mu"}] = 0.1
    words = {cure.name: cure for cure in answer.cures(told)}
    assert (words["mu"].quiet_from, words["mu"].any_start) == ("none", "0.1")
    assert "mu" not in {cure.name for cure in answer.of_a_push(told)}
    assert answer.NAMES["mu"] not in dict(answer.not_cures(told))


def test_a_cure_that_a_blow_undoes_is_told_after_the_one_that_is_safe(answers):
    """ "alpha2 quiet from 50.6°" was all that was said of a pad that hammers there if struck."""
    told = answers["mine"].copy(deep=True)
    told["verdict"], told["quiet_unless_struck"] = Verdict.hammers, False
    for key in ("quiet_from", "quiet_from_any_start", "change", "change_any_start"):
        told[key][:] = np.nan
    found = {
        "alpha2": (math.radians(50.6), math.radians(56.5), 0.6, 6.5),
        "mu": (0.3, 0.3, -5.0, -5.0),
        "k3": (7e6, np.nan, 1.0, np.nan),
    }
    told.value.loc[{"cure": "alpha2"}] = math.radians(50.0)
    for name, row in found.items():
        keys = ("quiet_from", "quiet_from_any_start", "change", "change_any_start")
        for key, number in zip(keys, row, strict=True):
            told[key].loc[{"cure": name}] = number
    box = scene("mine", told, simulate(PAD, 0.5, 2.4, t_end=20 * PAD.time_unit))
    said = [line.strip() for line in answer.lines(told)]
    assert box["cheapest"] == said[said.index(box["cheapest"][0]) :][:3]
    mu, alpha2, k3 = box["cheapest"]
    assert alpha2.endswith("quiet from 56.5° (+6.5°); from 50.6° unless struck")
    assert mu.endswith("quiet from 0.3 (−5 %)")
    assert k3.endswith("quiet from 7 kN/mm (+1 %) unless struck")
    told["verdict"] = Verdict.quiet
    (alpha2,) = (row for row in answer.of_a_push(told) if row.name == "alpha2")
    line = answer.cure_line(alpha2, told)
    assert line.endswith("quiet up to 56.5° (+6.5°); up to 50.6° unless struck")
    told["quiet_unless_struck"], told["sliding_growth_rate"] = True, -1.0
    line = answer.cure_line(alpha2, told)
    assert line.endswith(
        "dies out up to 50.6° (+0.6°); quiet from any start at 56.5° (+6.5°)"
    )
    assert "small motions die out, but" in answer.headline(told)


def test_nothing_is_said_to_die_out_where_nothing_damps_it(answers):
    told = answers["mine"].copy(deep=True)
    told["verdict"], told["quiet_unless_struck"] = Verdict.quiet, True
    told["sliding_growth_rate"] = 0.0
    words = answer.of_a_push(told)
    told_of = [answer.headline(told), *(answer.cure_line(each, told) for each in words)]
    assert "small motions stay small, but" in told_of[0]
    assert any("a small push stays small up to" in line for line in told_of)
    assert not any("die" in line for line in told_of)


def test_what_has_not_settled_has_no_time_by_which_it_had(answers):
    told = answers["mine"].copy(deep=True)
    told["verdict"] = Verdict.undetermined
    shown = scene("mine", told, simulate(PAD, 0.5, 2.4, t_end=20 * PAD.time_unit))
    assert shown["numbers"][-1]["pushed"] == "not settled"
    assert shown["numbers"][-1]["sudden"].endswith("s")
    assert shown["level"].startswith("Level at the end")
    assert "; it does not repeat; " in shown["motion"]


def test_a_table_of_friction_stands_for_the_coefficient(tmp_path):
    pad = replace(PAD, mu=Parameters().mu, friction_law="linear 0.0:0.48 1.0:0.36")
    rows = {row["meaning"]: row for row in parameter_table(pad, of_a1=True)}
    assert "sliding friction coefficient" not in rows
    assert (
        rows["friction law"]["value"] == "table, linear: 0.48 at 0 m/s, 0.36 at 1 m/s"
    )
    assert rows["stiffness of spring 1"]["value"] == pytest.approx(10.0)
    assert rows["stiffness of spring 1"]["unit"] == "kN/mm"
    figure = draw(
        "own_model", {"own/mine": simulate(pad, 0.5, 2.4, t_end=20 * pad.time_unit)}
    )
    (panel,) = figure.axes
    assert any("$μ$: table" in text.get_text() for text in panel.texts)


def test_a_study_without_the_paper_needs_a_scene():
    with pytest.raises(ConfigError, match=r"scenes: \{mine"):
        parse_study({"paper": False})
    study = parse_study(
        {"paper": False, "scenes": {"a": {"alpha1": "30deg", "alpha2": "0.75pi"}}}
    )
    assert study.scenes["a"].alpha1 == pytest.approx(math.pi / 6)
    with pytest.raises(ConfigError, match="alpha1"):
        parse_study({"scenes": {"a": {"alpha1": "thirty", "alpha2": 1.0}}})


def test_init_own_writes_a_study_that_is_valid(tmp_path):
    file = tmp_path / "mine.yaml"
    assert run(["init", str(file), "--own"]) == 0
    study = read_study(ROOT / PAPER, file)
    assert not study.paper
    assert list(study.scenes) == ["mine"]
    assert study.parameters.k3 == 7e6
    assert study.parameters.friction_law == "exponential"
