"""The report of a study of one's own, with the numbers of a real pad."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from squealpipe.cli import run
from squealpipe.config.mistakes import ConfigError
from squealpipe.config.settings import PAPER, parse_study, read_study
from squealpipe.parameters import Parameters
from squealpipe.plotting.style import save_figure
from squealpipe.store import load
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamped
from squealpipe.study.figures.declared import draw, reads
from squealpipe.study.report.build import write_document
from squealpipe.study.report.content import Made, parameter_table, picture_files
from squealpipe.study.report.own import boundaries, gather_own
from squealpipe.tasks.curves.chart import regime_chart
from squealpipe.tasks.curves.contact import boundary_distance, contact_boundary
from squealpipe.tasks.dynamics.runs import simulate, validity_map
from squealpipe.tasks.own.scenes import own_scenes, variants
from squealpipe.tasks.propensity.distributions import centred
from squealpipe.tasks.propensity.propensity import propensity
from tests.conftest import ROOT

PAD = Parameters(
    mass=0.5, k1=1e7, k2=1e7, k3=7e6, mu=0.4, belt_speed=2.0, preload=2e-5, length1=0.02,
    length2=0.02,
)  # fmt: skip
SAME = Parameters(
    k3=0.7, mu=0.4, length1=1000.0, length2=1000.0, belt_speed=PAD.speed_ratio
)  # fmt: skip
REST = {"x": 0.0, "y": 0.0, "vx": 0.0, "vy": 0.0}


def scenes(speed):
    angles = {"alpha1": math.radians(30), "alpha2": math.radians(140), "t_end": 40.0}
    return {
        "mine": {**angles, "start": {**REST, "vx": speed}},
        "rest": {**angles, "start": REST},
    }


@pytest.fixture(scope="module")
def found():
    return own_scenes(PAD, scenes(1e-3))


def test_si_numbers_give_what_the_dimensionless_groups_give(found):
    speed = PAD.preload / PAD.time_unit
    same = own_scenes(SAME, scenes(1e-3 / speed))
    for name, unit in (
        ("return_peak_contact_force", 1.0),
        ("separated_fraction", 1.0),
        ("impact_speed", speed),
        ("largest_x", PAD.preload),
        ("first_separation_time", PAD.time_unit),
    ):
        # forces and displacements come from samples
        np.testing.assert_allclose(
            found[name], same[name] * unit, rtol=2e-2, err_msg=name
        )
    assert (found.motion == same.motion).all()


def test_a_start_from_rest_alone_asks_for_a_cheaper_level(found):
    assert (found.model.sel(scene="mine") == "A1").all()
    assert set(found.model.sel(scene="rest").values.tolist()) - {""}


def test_distance_to_the_nearest_other_cell():
    angles = np.radians([0.0, 10.0, 20.0, 30.0])
    lost = np.zeros((4, 4))
    lost[3, 1] = 1
    cells = {"separates": lost, "regime_linear": np.zeros((4, 4))}
    cells = {name: (("alpha1", "alpha2"), values) for name, values in cells.items()}
    validity = xr.Dataset(cells, {"alpha1": angles, "alpha2": angles})
    at = boundaries({"validity_map": validity}, "", math.radians(10), math.radians(10))
    assert at["lost"] is False
    assert at["lost_boundary"] == pytest.approx(20.0)
    assert at["unstable_boundary"] is None
    # half a turn further the springs come from the other side: another map
    at = boundaries(
        {"validity_map": validity}, "", math.radians(10), math.radians(10) + math.pi
    )
    assert at["lost"] is at["lost_boundary"] is None


def test_distributions_are_centred_on_the_study():
    given = centred(PAD, 0.5, 2.4)
    assert given["k1"]["mean"] == PAD.k1
    assert given["k3"]["median"] == PAD.k3
    assert (given["mu"]["low"], given["mu"]["high"]) == pytest.approx((0.4 / 3, 1.2))
    assert given["alpha2"]["mean"] == 2.4


def test_report_has_pages_without_the_paper(found, tmp_path):
    angles = np.linspace(0.0, math.pi, 13)
    end = 20 * PAD.time_unit
    boundary = contact_boundary(PAD, angles, angles, t_end=end)
    design = {f"alpha{i}": scenes(0.0)["mine"][f"alpha{i}"] for i in (1, 2)}
    distance = boundary_distance(boundary, design)
    datasets = {
        "own_scenes": found,
        "validity_map": validity_map(PAD, angles, angles, t_end=end),
        "validity_boundary": boundary,
        **{f"validity_distance/{name}": distance for name in scenes(0.0)},
        "propensity": propensity(
            PAD, 0.5, 2.4, distributions=centred(PAD, 0.5, 2.4), samples=64, t_end=end
        ),
        "angle_chart": regime_chart(
            PAD,
            angles,
            angles,
            design={"alpha1": [0.5], "alpha2": [2.4]},
            t_end=end / 10,
        ),
        "friction_chart/mine": regime_chart(
            PAD, 0.5, 2.4, kappa=angles[1:], mu=angles[1:] / 5, t_end=end / 10
        ),
        **{
            f"own/{name}": simulate(PAD, *design.values(), t_end=end)
            for name in scenes(0.0)
        },
    }
    config = {"parameters": PAD.as_dict()}
    here = boundaries(datasets, "mine", *design.values())
    other = boundaries(
        {"validity_map": datasets["validity_map"]}, "mine", *design.values()
    )
    assert here["lost"] is other["lost"]
    assert abs(here["lost_boundary"] - other["lost_boundary"]) < 1.5 * here["cell"]
    made, figures = {}, {}
    for name, dataset in datasets.items():
        path = save(
            stamped(lambda one=dataset: one, config=config),
            tmp_path / f"data/{name}.nc",
        )
        made[name] = Made(path=path, rule="some")
        datasets[name] = load(path)
    for name in ("own_model", "own_motion", "own_map", "propensity", "regime_charts"):
        path = tmp_path / f"{name}.png"
        save_figure(draw(name, datasets), [path])
        figures[name] = Made(path=path, rule="some", datasets=reads(name))
    content = gather_own(made, figures, PAD, [("dynamics.validity_points", 181, 13)])
    page = tmp_path / "index.html"
    pictures = picture_files(content, figures)
    write_document("study", content, pictures, page=page, pdf=tmp_path / "report.pdf")
    text = page.read_text(encoding="utf-8")
    words = " ".join(
        re.sub(r"<style>.*?</style>|<[^>]+>", " ", text, flags=re.DOTALL).split()
    )
    for absent in ("paper", "Fig.", "None", " nan"):
        assert absent not in words
    for present in (
        "pushed off the belt",
        "mine",
        "N m",
        "Nearest angles",
        "dynamics.validity_points 181 13",
    ):
        assert present in words
    assert text.count("<img") == len(figures)


def test_a_table_of_friction_stands_for_the_coefficient(found, tmp_path):
    pad = replace(PAD, mu=Parameters().mu, friction_law="linear 0.0:0.48 1.0:0.36")
    rows = {row["meaning"]: row for row in parameter_table(pad, of_a1=True)}
    assert "sliding friction coefficient" not in rows
    assert rows["friction law"]["value"] == "table, linear: 0.48 at 0, 0.36 at 1"
    assert rows["friction law"]["unit"] == "at m s⁻¹"
    figure = draw(
        "own_model", {"own/mine": simulate(pad, 0.5, 2.4, t_end=20 * pad.time_unit)}
    )
    (panel,) = figure.axes
    assert any("$μ$: table" in text.get_text() for text in panel.texts)


def test_a_law_that_depends_on_speed_is_set_beside_its_value_at_belt_speed():
    pad = replace(
        PAD, mu=Parameters().mu, friction_law="linear 0.0:0.48 1.0:0.36 3.0:0.3"
    )
    changed, _ = variants(pad, (0.0,) * 4)["friction as at belt speed, constant"]
    assert (changed.mu, changed.friction_law) == (pytest.approx(0.33), "coulomb")
    falling, _ = variants(PAD, (0.0,) * 4)["friction falls with speed"]
    assert falling.static_mu == pytest.approx(1.5 * PAD.mu)


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
