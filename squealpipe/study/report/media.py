"""Films and sounds in the page of a report, as data; nothing plays by itself."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape

import xarray as xr

from squealpipe.plotting.animation import film_of
from squealpipe.plotting.film import has_ffmpeg, video_element
from squealpipe.plotting.sound import comfortable_speed, sound


def media_of(name: str, motion: xr.Dataset, heard: Iterable[xr.Dataset] = ()) -> str:
    """Return film and sound of a settled motion as elements of a page.

    Args:
        name: of the scene or structure, for readers of screens.
        motion: dataset ``assess`` or ``structure_run``.
        heard: runs of the same motion to take the sound from, before the motion itself; the first
            that can be heard and has its pitch is taken.
    """
    parts = []
    if has_ffmpeg():
        # a film of 640 by 360 pixels, below 150 kB
        dpi = 80
        film = film_of(motion, dpi=dpi)
        video = video_element(film.mp4(), f"{name}: {film.scene.alt}")
        caption = escape(film.scene.caption)
        parts.append(
            f'<figure class="media">{video}<figcaption>{caption}</figcaption></figure>'
        )
    parts.append(_sound(name, motion, heard))
    return "\n".join(parts)


def _sound(name: str, motion: xr.Dataset, heard: Iterable[xr.Dataset]) -> str:
    """Return the sound of a motion, or a sentence on why there is none."""
    is_pad = motion.attrs.get("schema") == "assess"
    pitch = float(motion["frequency" if is_pad else "dominant_frequency"])
    speed, refusal = comfortable_speed(pitch), ""
    # a sound of 1 s takes 96 kB; it is repeated without a click
    seconds = 1.0
    for run in (*heard, motion):
        try:
            made = sound(run, seconds=seconds, speed=speed)
        except ValueError as error:
            refusal = str(error)
            continue
        # a longer run from another start counts only where it ends in the same motion
        if run is not motion and abs(made.frequency / pitch - 1.0) > 0.01:
            continue
        content = base64.b64encode(made.wav(seconds)).decode()
        told = escape(made.told())
        return (
            f'<figure class="media"><audio controls loop aria-label="Sound of {escape(name)}: '
            f'{told}" src="data:audio/wav;base64,{content}"></audio>'
            f"<figcaption>Sound: {told}.</figcaption></figure>"
        )
    return f'<p class="media">There is no sound: {escape(refusal)}.</p>'
