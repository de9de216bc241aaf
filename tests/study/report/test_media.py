"""Films and sounds in a report's page: small, labelled, still until somebody plays them."""

import base64
import re

import pytest

from squealpipe.plotting.sound import SAMPLING_RATE
from squealpipe.study.report.media import media_of
from tests.plotting.test_sound import heard, strongest
from tests.plotting.test_structure_motion import swaying

__all__ = ["swaying"]


@pytest.fixture(scope="module")
def elements(swaying):
    return media_of("my <pad>", swaying)


def test_film_and_sound_are_data_below_200_kb_each(elements):
    for kind in ("video/mp4", "audio/wav"):
        (content,) = re.findall(rf'src="data:{kind};base64,([^"]+)"', elements)
        assert len(content) < 200_000
    wav = re.search(r'audio/wav;base64,([^"]+)"', elements)[1]
    samples = heard(base64.b64decode(wav))
    assert strongest(samples, SAMPLING_RATE) == pytest.approx(500.0, abs=1.0)
    assert "http" not in elements


def test_readers_of_screens_and_keyboards_can_use_them(elements):
    for tag in ("video", "audio"):
        (found,) = re.findall(rf"<{tag} [^>]*?aria-label=\"[^\"]+\"", elements)
        assert " controls " in found
        assert "autoplay" not in found
        assert "my &lt;pad&gt;" in found


def test_a_motion_that_cannot_be_heard_is_said_so(swaying, monkeypatch):
    monkeypatch.setattr("squealpipe.study.report.media.has_ffmpeg", lambda: False)
    short = swaying.isel(time=slice(-60, None))
    told = media_of("pad", short)
    assert "There is no sound: the settled part of the run is too short" in told
