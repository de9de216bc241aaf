"""Write moving pictures: mp4 and html by ffmpeg, gif and html without it.

Idea: what stands still is drawn once and kept as pixels; in each frame only the artists that move
are drawn over it (Matplotlib's guide *Faster rendering by using blitting*), which takes a tenth of
drawing all. Invariant: a frame is what `figure.savefig` would draw at that instant.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from PIL import Image

from squealpipe.plotting import style
from squealpipe.plotting.motion_panels import FilmScene
from squealpipe.store.whole_files import whole_file

FRAMES_PER_SECOND = 25
"""Delays between pictures of a gif are whole hundredths of a second: 25 a second fit."""
NO_FFMPEG = (
    "films as .mp4 need ffmpeg; install it with `pip install imageio-ffmpeg`, or write .gif or "
    ".html, which do without it"
)


@dataclass(frozen=True)
class Film:
    """Frames of a scene.

    Attributes:
        count: number of frames.
        dpi: dots per inch of the figure.
    """

    scene: FilmScene
    count: int
    dpi: int = 120

    def frames(self) -> Iterator[np.ndarray]:
        """Draw the frames one after another, (height, width, 3) of 8 bit, even numbers."""
        figure = self.scene.figure
        figure.set_dpi(self.dpi)
        canvas: Any = FigureCanvasAgg(figure)
        for artist in self.scene.moving:
            artist.set_animated(True)
        self.scene.show(0)
        canvas.draw()
        still = canvas.copy_from_bbox(figure.bbox)
        for frame in range(self.count):
            canvas.restore_region(still)
            self.scene.show(frame)
            for artist in self.scene.moving:
                artist.axes.draw_artist(artist)
            pixels = np.asarray(canvas.buffer_rgba())[..., :3]
            height, width = (side - side % 2 for side in pixels.shape[:2])
            yield np.ascontiguousarray(pixels[:height, :width])
        for artist in self.scene.moving:
            artist.set_animated(False)

    def mp4(self) -> bytes:
        """Return a film in H.264.

        Raises:
            ValueError: there is no ffmpeg.
        """
        if not has_ffmpeg():
            raise ValueError(NO_FFMPEG)
        import tempfile

        import imageio_ffmpeg

        with tempfile.TemporaryDirectory(prefix="squealpipe-film-") as folder:
            path = Path(folder) / "film.mp4"
            writer: Any = None
            for pixels in self.frames():
                if writer is None:
                    height, width = pixels.shape[:2]
                    writer = imageio_ffmpeg.write_frames(
                        path,
                        (width, height),
                        fps=FRAMES_PER_SECOND,
                        codec="libx264",
                        quality=None,
                        macro_block_size=2,
                        output_params=[
                            *("-crf", "24", "-preset", "medium"),
                            # players begin before the whole file is there
                            *("-movflags", "+faststart"),
                            *("-metadata", f"comment={self.scene.caption}"),
                        ],
                    )
                    writer.send(None)
                writer.send(pixels)
            writer.close()
            return path.read_bytes()

    def gif(self) -> bytes:
        """Return a film as a gif that repeats for ever."""
        pictures = [Image.fromarray(pixels) for pixels in self.frames()]
        # one palette for all: colours that change from frame to frame flicker
        sample = Image.fromarray(
            np.concatenate(
                [np.asarray(picture) for picture in pictures[:: len(pictures) // 6 + 1]]
            )
        )
        # what is seen most has most colours of 64; those that mean something are kept as they are,
        # since marks of stick and of open contacts are small and would get one and the same
        colours = sample.quantize(
            64 - len(style.Colour.palette), method=Image.Quantize.MEDIANCUT
        ).getpalette()
        kept = [
            round(255 * part) for each in style.Colour.palette for part in to_rgb(each)
        ]
        palette = Image.new("P", (1, 1))
        palette.putpalette([*kept, *(colours or [])])
        shown = [
            picture.quantize(palette=palette, dither=Image.Dither.NONE)
            for picture in pictures
        ]
        content = io.BytesIO()
        shown[0].save(
            content,
            format="GIF",
            save_all=True,
            append_images=shown[1:],
            duration=1000 // FRAMES_PER_SECOND,
            loop=0,
            optimize=True,
            comment=self.scene.caption.encode("ascii", "replace"),
        )
        return content.getvalue()

    def player(self) -> str:
        """Return the element of a page that shows the film: a video, or its frames."""
        if has_ffmpeg():
            return video_element(self.mp4(), self.scene.alt)
        return self._frames_element()

    def _frames_element(self) -> str:
        """Return frames with a button and a slider: no codec is needed."""
        frames = []
        for pixels in self.frames():
            content = io.BytesIO()
            Image.fromarray(pixels).save(content, format="WEBP", quality=60, method=2)
            frames.append(base64.b64encode(content.getvalue()).decode())
        width, height = self.size()
        first = f"data:image/webp;base64,{frames[0]}"
        return (
            f'<img class="frames" alt="{escape(self.scene.alt)}" width="{width}" '
            f'height="{height}" src="{first}" data-frames="{" ".join(frames)}" '
            f'data-rate="{FRAMES_PER_SECOND}">'
            '<p class="controls"><button type="button">Play</button> '
            f'<input type="range" min="0" max="{self.count - 1}" value="0" '
            'aria-label="Position in the film"></p>'
        )

    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        width, height = (
            int(side * self.dpi) for side in self.scene.figure.get_size_inches()
        )
        return width - width % 2, height - height % 2

    def page(self, title: str) -> str:
        """Return a page of its own that shows the film."""
        shell = files("squealpipe.plotting") / "film.html"
        return Template(shell.read_text(encoding="utf-8")).substitute(
            title=escape(title),
            player=self.player(),
            caption=escape(self.scene.caption),
        )


def has_ffmpeg() -> bool:
    """Tell whether there is an ffmpeg that films can be written by."""
    if find_spec("imageio_ffmpeg") is None:
        return False
    import imageio_ffmpeg

    try:
        imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError:
        return False
    return True


def video_element(content: bytes, alt: str) -> str:
    """Return a video with its content, which the page's script plays where motion is welcome."""
    return (
        f'<video class="film" controls loop muted playsinline tabindex="0" '
        f'aria-label="{escape(alt)}" '
        f'src="data:video/mp4;base64,{base64.b64encode(content).decode()}"></video>'
    )


def write_film(film: Film, path: Path, title: str) -> None:
    """Write a film by the suffix of its name, whole or not at all.

    Raises:
        ValueError: there is no ffmpeg, which .mp4 needs.
    """
    if path.suffix == ".mp4":
        content = film.mp4()
    elif path.suffix == ".gif":
        content = film.gif()
    else:
        content = film.page(title).encode()
    with whole_file(path) as temporary:
        temporary.write_bytes(content)
