"""The explorer page: what it holds, and that it works in a real browser."""

import base64
import json
import re

import numpy as np
import pytest

from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.brake.explorer import explorer_data
from squealpipe.brake.ladder.ladder import model_ladder
from squealpipe.brake.linear.maps import natural_frequencies, stability_map
from squealpipe.cli import run
from squealpipe.parameters import Parameters
from squealpipe.store import load
from squealpipe.study.report.explorer import (
    blocks,
    in_script,
    payload,
    run_options,
    write_explorer,
)
from squealpipe.study.report.explorer.layers import layers
from tests.browser import chromium_path, open_page

ANGLES = np.linspace(0, np.pi, 7)
FINE = np.linspace(0, np.pi, 13)
OPTIONS = (
    "--t-end 60 --points 301 --mass 1 --k1 1 --k2 1 --k3 0.65 --mu 0.3 --belt-speed 100 "
    "--preload 1 --length1 15 --length2 15 --sigma 1000"
)
CURVE = "document.getElementById('{}').chart.traces[{}]"

in_browser = [
    pytest.mark.release,
    pytest.mark.skipif(chromium_path() is None, reason="no chromium on this machine"),
]


@pytest.fixture(scope="module")
def explorer():
    return explorer_data(
        Parameters(),
        ANGLES,
        history_time=30.0,
        spectrum_time=60.0,
        samples=151,
        branch_points=8,
    )


@pytest.fixture(scope="module")
def shown():
    params = Parameters()
    return layers(
        stability=stability_map(params, FINE, FINE),
        frequencies=natural_frequencies(params, FINE, FINE),
        validity=validity_map(params, FINE, FINE, t_end=50.0),
        hammering=hammering_map(params, FINE, FINE, t_end=50.0),
        ladder=model_ladder(params, 7, 0.05, t_end=50.0),
    )


@pytest.fixture(scope="module")
def page_file(explorer, shown, tmp_path_factory):
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    write_explorer(explorer, shown, path, {"mine": {"alpha1": 0.7, "alpha2": 2.4}})
    return path


@pytest.fixture
def opened(page_file):
    with open_page(page_file.as_uri()) as (page, faults):
        page.wait_for_function("document.body.dataset.ready === 'true'")
        yield page
        assert faults == []


def test_curves_survive_packing(explorer, shown):
    text = blocks(explorer, shown)["x"]
    count = explorer.sizes["time"]
    length = len(text) // explorer.outcome.size
    records = [
        base64.b64decode(text[at : at + length]) for at in range(0, len(text), length)
    ]
    heads = np.array([np.frombuffer(record[:8], "<f4") for record in records])
    numbers = np.array([np.frombuffer(record[8:], "<u2") for record in records])
    curves = numbers * heads[:, 1:] + heads[:, :1]
    x = explorer.x.values.reshape(-1, count)
    error = np.abs(curves - x).max(axis=1)
    assert (error <= np.ptp(x, axis=1) / 65535 + 1e-6).all()


def test_page_is_one_file_and_all_but_data_is_small(page_file, explorer, shown):
    text = page_file.read_text(encoding="utf-8")
    assert len(text) - sum(map(len, blocks(explorer, shown).values())) < 60e3


def test_the_command_repeats_what_is_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    params = Parameters(mass=2.0, k1=1.5, k3=0.9, mu=0.2, belt_speed=-3.0, preload=0.1)
    made = explorer_data(
        params,
        ANGLES[3:5],
        history_time=9.0,
        spectrum_time=20.0,
        samples=31,
        branch_points=3,
        workers=1,
    )
    command = ["simulate", "pi/2", "2pi/3", *run_options(made).split(), "-q"]
    assert run(command) == 0
    again = load("run.nc")
    np.testing.assert_allclose(again.time[:31], made.time, rtol=1e-12)
    np.testing.assert_allclose(again.x[:31], made.x[0, 1], rtol=1e-6, atol=1e-9)


def test_page_survives_a_meaning_that_looks_like_markup(explorer, shown, tmp_path):
    """A comment and a script tag in data would otherwise hide the rest of the page."""
    text = in_script({"meaning": "<!--<script>", "label": "</script>&amp;"})
    assert not {"<", ">"} & set(text)
    assert json.loads(text) == {"meaning": "<!--<script>", "label": "</script>&amp;"}
    hostile = explorer.copy()
    meanings = explorer.outcome.attrs["flag_meanings"].replace(
        "converged", "<!--<script>"
    )
    hostile["outcome"].attrs = {**explorer.outcome.attrs, "flag_meanings": meanings}
    write_explorer(hostile, shown, tmp_path / "e.html")
    text = (tmp_path / "e.html").read_text(encoding="utf-8")
    assert "<!--<script>" not in text
    assert payload(hostile, shown, {})["outcome"]["meanings"][0] == "<!--<script>"


@pytest.mark.usefixtures("page_file")
class TestInBrowser:
    pytestmark = in_browser

    def curve(self, page, panel, axis="y"):
        return np.array(
            page.evaluate(f"Array.from({CURVE.format(panel, 0)}.{axis})"), float
        )

    def test_first_pair_is_shown_and_matches_the_dataset(self, opened, explorer):
        np.testing.assert_allclose(
            self.curve(opened, "force"),
            explorer["normalized_contact_force"].values[5, 5],
            atol=5e-5,
        )
        assert (
            opened.inner_text("#command")
            == f"squealpipe simulate 5pi/6 5pi/6 {OPTIONS}"
        )
        assert opened.get_attribute("nav a", "href") == "index.html"
        height = f"{CURVE.format('orbit', 5)}.y[0]"
        before = opened.evaluate(height)
        opened.click("#play")
        opened.wait_for_function(f"{height} !== {before}", timeout=5000)

    def test_click_changes_every_panel_to_the_dataset(self, opened, explorer):
        box = opened.evaluate(
            "document.getElementById('map').chart.pixel(Math.PI / 3, Math.PI / 2)"
        )
        opened.mouse.click(*box)
        opened.wait_for_function(
            "document.getElementById('alpha1-text').value === '= π/3'"
        )
        for panel, name in (("force", "normalized_contact_force"), ("orbit", "y")):
            reference = explorer[name].values[2, 3]
            np.testing.assert_allclose(
                self.curve(opened, panel),
                reference,
                atol=1e-4 * max(1, np.ptp(reference)),
            )
        reference = explorer["force_spectrum"].values[2, 3]
        np.testing.assert_allclose(self.curve(opened, "spectrum"), reference, atol=1e-4)
        np.testing.assert_allclose(
            self.curve(opened, "backbones", "x"),
            explorer["omega"].values[2, 3][0],
            rtol=1e-6,
        )

    def test_arrow_keys_move_the_pair(self, opened):
        opened.focus("#map")
        opened.keyboard.press("ArrowLeft")
        opened.keyboard.press("ArrowDown")
        opened.keyboard.press("ArrowDown")
        assert opened.inner_text("#alpha1-text") == "= 2π/3"
        assert opened.inner_text("#alpha2-text") == "= π/2"

    def test_every_layer_can_be_chosen_and_tells_its_value_under_the_mouse(
        self, opened, shown
    ):
        def told(i, j, layer):
            x, y = opened.evaluate(
                f"document.getElementById('map').chart.pixel({layer.map.alpha1.values[i]}, "
                f"{layer.map.alpha2.values[j]})"
            )
            opened.mouse.move(x + 1, y + 1)
            return opened.inner_text("#map .tip").split("\n")

        for key, layer in shown.items():
            opened.select_option("#layer", key)
            for i, j in ((3, 2), (1, 5), (0, 0)):
                where, value = told(i, j, layer)
                if not layer.meanings and np.isfinite(layer.map.values[i, j]):
                    assert float(value.split()[0].replace("−", "-")) == pytest.approx(
                        layer.map.values[i, j], rel=1e-3, abs=1e-9
                    )
                else:
                    assert value == layer.meanings.get(layer.map.values[i, j], "none")
            assert re.fullmatch("α₁ = .*0|α₁ = π/14, α₂ = π/14", where)
        rows = opened.locator("#facts tr").all_inner_texts()
        assert [row.split("\t")[0] for row in rows][:-1] == [
            one.label for one in shown.values()
        ]

    def test_the_map_has_the_colours_of_its_categories(self, opened, shown):
        layer = shown["motion"]
        opened.select_option("#layer", "motion")
        pixels = opened.evaluate(
            """(async () => { const image = new Image();
            image.src = document.querySelector('#map image').getAttribute('href');
            await image.decode();
            const canvas = document.createElement('canvas'), pen = canvas.getContext('2d');
            [canvas.width, canvas.height] = [image.width, image.height];
            pen.drawImage(image, 0, 0);
            return Array.from(pen.getImageData(0, 0, image.width, image.height).data); })()"""
        )
        seen = np.array(pixels).reshape(*layer.map.values.T.shape, 4)[::-1, :, :3]
        wanted = [
            [list(bytes.fromhex(layer.colours[code][1:])) for code in row]
            for row in layer.map.values.T
        ]
        np.testing.assert_array_equal(seen, wanted)

    def test_a_curve_tells_its_point_and_can_be_enlarged(self, opened, explorer):
        force = explorer["normalized_contact_force"].values[5, 5]
        x, y = opened.evaluate(
            f"document.getElementById('force').chart.pixel({float(explorer.time[40])}, {force[40]})"
        )
        opened.mouse.move(x, y)
        first, second = opened.inner_text("#force .tip").split("\n")
        assert float(first.removeprefix("t = ").removesuffix(" s")) == pytest.approx(
            float(explorer.time[40])
        )
        assert float(second.split(" = ")[1]) == pytest.approx(force[40], abs=1e-3)
        ticks = opened.locator("#force .xtick").all_text_contents()
        opened.mouse.down()
        opened.mouse.move(x + 60, y + 40)
        opened.mouse.up()
        assert opened.locator("#force .xtick").all_text_contents() != ticks
        opened.mouse.dblclick(x, y)
        assert opened.locator("#force .xtick").all_text_contents() == ticks

    def test_a_picture_is_saved_whole(self, opened):
        opened.hover("#orbit")
        with opened.expect_download() as started:
            opened.click("#orbit .save")
        saved = started.value
        assert saved.suggested_filename == "orbit.svg"
        assert re.fullmatch(r"<svg xmlns=.*</svg>", saved.path().read_text(), re.DOTALL)

    def test_scenes_open_the_pair_that_they_name(self, opened):
        names = opened.locator("#scenes button").all_inner_texts()
        assert "Fig. 2(d): 5π/6, 5π/6" in names
        assert names[-1].startswith("mine: ")
        for place, name in enumerate(names):
            opened.locator("#scenes button").nth(place).click()
            shown = [opened.inner_text(f"#alpha{k}-text") for k in (1, 2)]
            assert name.endswith(
                ": " + ", ".join(item.removeprefix("= ") for item in shown)
            )

    @pytest.mark.parametrize("scheme", ["light", "dark"])
    def test_text_stands_out_in_both_schemes(self, page_file, scheme):
        with open_page(page_file.as_uri(), scheme=scheme) as (page, faults):
            page.wait_for_function("document.body.dataset.ready === 'true'")
            ink, paper = page.evaluate(
                "[getComputedStyle(document.querySelector('#force .xtick')).fill,"
                " getComputedStyle(document.body).backgroundColor]"
            )
            light = [
                sum(map(int, re.findall(r"\d+", value)[:3])) / 765
                for value in (ink, paper)
            ]
            assert (light[0] < light[1]) == (scheme == "light")
            assert abs(light[0] - light[1]) > 0.6
            assert faults == []

    def test_phone_width_needs_no_sideways_scroll_and_the_address_chooses_the_pair(
        self, page_file
    ):
        address = f"{page_file.as_uri()}#0.5,1"
        with open_page(address, width=390, height=844) as (page, faults):
            page.wait_for_function("document.body.dataset.ready === 'true'")
            assert page.evaluate("document.documentElement.scrollWidth") <= 390
            for panel in ("map", "force", "orbit", "spectrum", "backbones"):
                assert page.locator(f"#{panel}").bounding_box()["width"] > 300
            assert (
                page.inner_text("#command") == f"squealpipe simulate pi/2 pi {OPTIONS}"
            )
            tops = page.evaluate(
                "[...document.querySelectorAll('#map circle')].map((mark) => "
                "mark.cy.baseVal.value - mark.r.baseVal.value)"
            )
            assert len(tops) == 2
            assert min(tops) >= 0  # not clipped at π
            assert faults == []


@pytest.fixture(scope="module")
def own_page(tmp_path_factory):
    """Of a study without the paper, with a friction law that A4 does not carry."""
    pad = Parameters(
        mass=0.5,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        belt_speed=2.0,
        preload=2e-5,
        length1=0.02,
        length2=0.02,
        friction_law="linear 0.0:0.48 1.0:0.36",
    )
    times = {
        "history_time": 30.0,
        "spectrum_time": 60.0,
        "samples": 151,
        "branch_points": 8,
    }
    validity = validity_map(pad, ANGLES, ANGLES, t_end=50 * pad.time_unit)
    path = tmp_path_factory.mktemp("own") / "explorer.html"
    # half a turn further the spring comes from the other side, which the explorer's map has not
    scenes = {
        "behind": {"alpha1": 0.5, "alpha2": 2.1 + np.pi},
        "mine": {"alpha1": 0.5, "alpha2": 2.1},
        "other": {"alpha1": 1.0, "alpha2": 2},
    }
    maps = layers(validity=validity)
    write_explorer(explorer_data(pad, ANGLES, **times), maps, path, scenes, paper=False)
    return path


def test_a_study_without_the_paper_has_its_own_scenes_and_no_backbones(own_page):
    text = own_page.read_text()
    words = re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    for absent in ("Fig", "paper", "Backbones"):
        assert absent not in words
    shown = json.loads(text.partition('id="payload">')[2].partition("</script>")[0])
    assert [scene["name"] for scene in shown["scenes"]] == ["mine", "other"]
    assert shown["scenes"][0]["angles"] == pytest.approx([0.5, 2.1])
    assert "--friction-law 'linear 0.0:0.48 1.0:0.36'" in shown["options"]
