"""Films of pads: what is drawn, in pixels, against the dataset; files that open."""

import io
import sys

import imageio_ffmpeg
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image
from scipy.ndimage import binary_erosion, center_of_mass, label

from squealpipe import Parameters, load, simulate
from squealpipe.cli import run
from squealpipe.codes import Regime
from squealpipe.plotting import film, style
from squealpipe.plotting.animation import film_of, phases
from squealpipe.plotting.pad_motion import PadMotion
from squealpipe.store import save
from tests.browser import chromium_path, open_page
from tests.plotting.test_sound import PAD

ANGLES = np.radians((22, 46))


@pytest.fixture(scope="module")
def pad():
    return simulate(PAD, *ANGLES, t_end=0.1)


def decoded(content, tmp_path):
    """Frames of a film, and frames per second, by ffmpeg."""
    path = tmp_path / "film.mp4"
    path.write_bytes(content)
    reader = imageio_ffmpeg.read_frames(path)
    facts = next(reader)
    width, height = facts["size"]
    frames = [
        np.frombuffer(each, np.uint8).reshape(height, width, 3) for each in reader
    ]
    return frames, facts["fps"]


def mass_in(pixels):
    """Middle of the largest dark spot in the left panel, pixels from the lower left."""
    dark = pixels[:, : pixels.shape[1] * 57 // 100].max(axis=2) < 60
    spots, _ = label(binary_erosion(dark, iterations=2))  # lines go
    largest = np.bincount(spots.ravel())[1:].argmax() + 1
    row, column = center_of_mass(spots == largest)
    return np.array([column, pixels.shape[0] - 1 - row])


def test_a_mirrored_pad_slips_slower_than_its_belt_all_the_same():
    # x → −x swaps the angles and turns the belt
    there = PadMotion.read(simulate(PAD, *ANGLES, t_end=0.02))
    mirrored = simulate(
        PAD.with_(belt_speed=-PAD.belt_speed), *ANGLES[::-1], t_end=0.02
    )
    back = PadMotion.read(mirrored)
    assert set(there.regimes) >= {Regime.slip_slower, Regime.separated}
    assert np.mean(there.regimes == back.regimes) > 0.99
    assert (back.regimes == Regime.slip_slower).any()
    assert (mirrored.regime == Regime.slip_faster).any()


@pytest.mark.parametrize(
    ("belt_speed", "degrees"),
    [
        pytest.param(2.0, (22.0, 46.0), marks=pytest.mark.release),
        (-3.0, (150.0, 135.0)),
    ],
)
def test_the_drawn_mass_is_where_the_dataset_says(belt_speed, degrees, tmp_path):
    pad = simulate(PAD.with_(belt_speed=belt_speed), *np.radians(degrees), t_end=0.1)
    made = film_of(pad, seconds=1.0, dpi=80)
    frames, rate = decoded(made.mp4(), tmp_path)
    assert (len(frames), rate) == (25, 25)
    shown = made.scene.shown.time
    assert shown[-1] < float(pad.time[-1])
    truth = np.stack([np.interp(shown, pad.time, pad[name]) for name in "xy"], axis=1)
    seen = np.array([mass_in(frames[k]) for k in (1, 7, 14, 22)])
    moved = truth[[1, 7, 14, 22]]
    # one scale for both directions: displacements times so many, in pixels
    scale = made.scene.drawn.geometry.scale
    axes = made.scene.drawn.axes
    per_metre = axes.bbox.width / np.diff(axes.get_xlim())[0]
    expected = scale * per_metre * (moved - moved.mean(axis=0))
    assert np.abs(expected).max() > 15.0
    assert np.abs(seen - seen.mean(axis=0) - expected).max() < 1.0


def test_a_period_takes_a_second_unless_asked(pad):
    period = 1 / 828.5
    shown = film_of(pad).scene.shown.time
    assert shown.size == 75
    assert shown[-1] - shown[0] == pytest.approx(3 * period * 74 / 75, rel=0.01)
    fast = film_of(pad, seconds=2.0, periods=8.0).scene.shown.time
    assert fast.size == 50
    assert fast[-1] - fast[0] == pytest.approx(8 * period * 49 / 50, rel=0.01)
    begun = film_of(pad, begin=0.0).scene.shown.time
    assert begun[0] == 0.0


def test_what_the_contact_does_is_told_by_colour_and_word(pad):
    made = film_of(pad)
    scene = made.scene
    words = {}
    for frame, regime in enumerate(scene.shown.regimes):
        scene.show(frame)
        state = scene.drawn.state
        words.setdefault(state.get_text(), set()).add(state.get_color())
        lifted = scene.drawn.foot.get_ydata()[0] > scene.drawn.geometry.belt
        y = scene.shown.place[frame, 1]
        assert (state.get_text() == "open") == (regime == 3)
        assert lifted == (regime == 3 and y > float(pad.preload))
    assert {"slip", "open"} <= set(words)
    assert all(len(colours) == 1 for colours in words.values())


def test_a_frame_is_what_the_figure_shows(pad):
    """Blitting draws what drawing everything would."""
    made = film_of(pad, seconds=0.2)
    frames = list(made.frames())
    made.scene.show(2)
    content = io.BytesIO()
    made.scene.figure.savefig(content, dpi=made.dpi)
    whole = np.asarray(Image.open(content).convert("RGB")).astype(int)
    assert np.abs(whole - frames[2]).mean() < 0.2


def test_a_gif_repeats_and_has_the_frames_of_the_film(pad):
    made = film_of(pad, seconds=0.56, dpi=60)
    with Image.open(io.BytesIO(made.gif())) as picture:
        assert picture.n_frames == 14
        assert picture.info["duration"] == 40
        assert picture.info["loop"] == 0
        # marks are small: those of stick and of open contacts once had one colour
        palette = np.array(picture.getpalette()).reshape(-1, 3).tolist()
    for colour in (style.Colour.orange, style.Colour.red):
        assert [round(255 * part) for part in to_rgb(colour)] in palette


def test_without_ffmpeg_a_page_shows_frames_and_mp4_is_refused(pad, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(film, "find_spec", lambda _: None)
    made = film_of(pad, seconds=0.2, dpi=60)
    assert 'class="frames"' in made.page("A pad")
    with pytest.raises(ValueError, match=r"imageio-ffmpeg.*\.gif or \.html"):
        made.mp4()


@pytest.mark.release
@pytest.mark.skipif(chromium_path() is None, reason="needs Chromium")
@pytest.mark.parametrize("with_ffmpeg", [True, False])
def test_the_page_plays_by_keyboard_and_not_by_itself_for_who_wants_no_motion(
    pad, tmp_path, monkeypatch, with_ffmpeg
):
    if not with_ffmpeg:
        monkeypatch.setattr(film, "find_spec", lambda _: None)
    path = tmp_path / "film.html"
    film.write_film(film_of(pad, dpi=60), path, "A pad")
    with open_page(path.as_uri()) as (page, faults):  # asks for reduced motion
        shown = page.locator("video.film" if with_ffmpeg else "img.frames")
        words = shown.get_attribute("aria-label" if with_ffmpeg else "alt")
        assert words.startswith("Film of a mass on two springs at 22° and 46°")
        page.wait_for_timeout(400)
        if with_ffmpeg:
            assert shown.evaluate("video => video.readyState >= 2 && video.paused")
            shown.focus()
            page.keyboard.press("Space")
            page.wait_for_timeout(500)
            assert shown.evaluate("video => video.currentTime") > 0.1
        else:
            before = shown.get_attribute("src")
            page.keyboard.press("Tab")
            page.keyboard.press("Enter")
            page.wait_for_timeout(500)
            assert page.locator("button").inner_text() == "Pause"
            assert shown.get_attribute("src") != before
        assert not faults


def test_what_has_died_out_is_drawn_still():
    """Round-off would fill the picture if it were enlarged as a motion is."""
    quiet = simulate(PAD.with_(mu=0.0, mu_static=0.0), *ANGLES, t_end=1.0)
    made = film_of(quiet, seconds=0.2)
    middles = made.scene.drawn.middles
    assert np.ptp(middles, axis=0).max() < 1e-3 * made.scene.drawn.geometry.size


def test_a_strip_has_eight_phases(pad):
    figure = phases(pad)
    drawn = [axes for axes in figure.axes if axes.texts]
    assert len(drawn) == 8
    assert {axes.texts[-1].get_text() for axes in drawn} >= {"slip", "open"}
    # whatever repeats, a motion that beats has no period of its own
    assert figure.get_suptitle().startswith("one period of its strongest line, ")


def test_a_run_without_motion_and_wrong_arguments_are_refused(pad):
    for wrong in (
        {"seconds": 0.0},
        {"seconds": 1e3},
        {"periods": -1.0},
        {"begin": 5.0},
    ):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))} = "):
            film_of(pad, **wrong)
    coarse = simulate(PAD, *ANGLES, t_end=0.1, times=np.linspace(0.0, 0.1, 400))
    with pytest.raises(ValueError, match="--points"):
        film_of(coarse)
    still = simulate(Parameters(mu=0.0, preload=1e-9), 1.0, 1.0, t_end=10.0)
    assert film_of(still, seconds=0.2).count == 5


def test_the_command_writes_a_film(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    save(simulate(PAD, *ANGLES, t_end=0.1, times=np.linspace(0.0, 0.1, 400)), "run.nc")
    assert run(["animate", "run.nc", "--seconds", "1", "--dpi", "60"]) == 0
    assert "828 times slower than in reality" in capsys.readouterr().out.replace(
        "830", "828"
    )
    frames, _ = decoded((tmp_path / "run.mp4").read_bytes(), tmp_path)
    assert frames[0].shape == (270, 480, 3)
    assert run(["animate", "run.nc", "-o", "run.avi"]) == 2
    assert ".mp4, .gif or .html" in capsys.readouterr().err
    assert load("run.nc").sizes["time"] == 400
