"""Which marks a figure shows, and which ones its caption and its legends name."""

import re
from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection
from matplotlib.colors import rgb_to_hsv, same_color, to_rgb
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

HUES = {
    "red": (0.94, 1.09),
    "orange": (0.09, 0.17),
    "green": (0.3, 0.5),
    "blue": (0.5, 0.7),
    "purple": (0.75, 0.94),
}
"""From where to where on the wheel of colours a name goes; red goes past its end."""
TONES = {"black": (0.0, 0.25), "grey": (0.3, 0.95), "white": (0.97, 1.0)}
COLOURLESS = 0.1
"""Saturation up to which a colour is black, grey or white."""
MARKERS = {
    "circles?": "o",
    "circled": "o",
    "rings?": "o",
    "dots?": ".o",
    "triangles?": "^v<>",
    "cross(es)?": "xX",
    "crossed out": "xX",
    "stars?": "*",
    "squares": "s",
}
DASHES = {"dotted": "dotted", "dashed": "dashed"}


def _rgb(colours) -> np.ndarray:
    """Opaque colours as rows of RGB, as they look on white."""
    rows = np.atleast_2d(np.asarray(colours, float)).reshape(
        -1, np.shape(colours)[-1] or 4
    )
    if rows.shape[1] == 4:
        rows = rows[:, :3] * rows[:, 3:] + 1.0 - rows[:, 3:]
    return np.unique(rows.round(3), axis=0)


def _all(figure: Figure) -> Iterator[Artist]:
    """Visible artists that show data: those of legends and of ticks are none."""
    hidden = {
        id(part)
        for legend in figure.findobj(Legend)
        for part in [legend, *legend.findobj()]
    }
    for axes in figure.findobj(Axes):
        for axis in (axes.xaxis, axes.yaxis):
            hidden |= {id(part) for part in axis.findobj()}
        hidden |= set(map(id, axes.spines.values()))
        if same_color(axes.get_facecolor(), "white"):
            hidden.add(id(axes.patch))
    hidden |= {id(part.patch) for part in [figure, *figure.subfigs]}
    for artist in figure.findobj():
        if id(artist) not in hidden and artist.get_visible():
            yield artist


def _lines(figure: Figure) -> list[Line2D]:
    """Lines with at least one point."""
    return [
        artist
        for artist in _all(figure)
        if isinstance(artist, Line2D)
        and np.isfinite(np.asarray(artist.get_xydata(), float)).all(axis=1).any()
    ]


def _dash(line: Line2D) -> str:
    """Solid, dashed, dotted or none."""
    look = line.get_linestyle()
    if look in {"None", "none", "", " "}:
        return "none"
    pattern = line._unscaled_dash_pattern[1]
    if not pattern:
        return "solid"
    return "dotted" if max(pattern[::2]) <= 1.2 else "dashed"


def colours_of(figure: Figure) -> np.ndarray:
    """All colours of what is drawn, RGB."""
    rows = []
    for artist in _all(figure):
        if isinstance(artist, AxesImage):
            rows.append(_rgb(artist.to_rgba(artist.get_array()).reshape(-1, 4)))
        elif isinstance(artist, Collection):
            artist.update_scalarmappable()
            rows += [
                _rgb(each)
                for each in (artist.get_facecolor(), artist.get_edgecolor())
                if np.size(each)
            ]
        elif isinstance(artist, Patch):
            rows += [_rgb([artist.get_facecolor()]), _rgb([artist.get_edgecolor()])]
        elif isinstance(artist, Text) and artist.get_text():
            rows.append(_rgb([to_rgb(artist.get_color())]))
    for line in _lines(figure):
        rows += [_rgb([to_rgb(line.get_color())])]
        if line.get_marker() not in {"None", "none", "", " ", None}:
            faces = (line.get_markerfacecolor(), line.get_markeredgecolor())
            rows += [
                _rgb([to_rgb(c)])
                for c in faces
                if isinstance(c, str | tuple)
                and not (isinstance(c, str) and c == "none")
            ]
    return np.unique(np.concatenate(rows), axis=0)


def _is_named(colours: np.ndarray, word: str) -> np.ndarray:
    """Which colours go by a name."""
    hue, saturation, value = rgb_to_hsv(np.clip(colours, 0.0, 1.0)).T
    if word in TONES:
        low, high = TONES[word]
        return (saturation <= COLOURLESS) & (value >= low) & (value <= high)
    low, high = HUES[word]
    inside = ((hue >= low) & (hue < high)) | (hue + 1.0 < high)
    return inside & (saturation > 2.0 * COLOURLESS)


def undrawn_marks(figure: Figure, caption: str) -> list[str]:
    """Words of a caption for colours, markers and lines that the figure does not show."""
    # what is named with a condition need not be there
    text = re.sub(r"[^;.]*, if there (are any|is one)", "", caption.lower())
    shown, lines = colours_of(figure), _lines(figure)
    markers = {str(line.get_marker()) for line in lines}
    dashes = {_dash(line) for line in lines}
    words = []
    words += [
        word
        for word in (*HUES, *TONES)
        if re.search(rf"\b{word}\b", text) and not _is_named(shown, word).any()
    ]
    for word, signs in MARKERS.items():
        if re.search(rf"\b{word}\b", text) and not markers & set(signs):
            words.append(word)
    words += [
        word
        for word, dash in DASHES.items()
        if re.search(rf"\b{word}\b", text) and dash not in dashes
    ]
    if "hatch" in text and not any(
        artist.get_hatch() or getattr(artist, "hatches", [None])[0]
        for artist in _all(figure)
        if isinstance(artist, Patch | Collection)
    ):
        words.append("hatched")
    return words


def undrawn_entries(figure: Figure) -> list[str]:
    """Entries of legends that stand for nothing that is drawn."""
    shown, lines = colours_of(figure), _lines(figure)
    words = []
    for legend in figure.findobj(Legend):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if isinstance(handle, Line2D):
                drawn = _line_is_drawn(handle, lines)
            else:
                face = handle.get_facecolor() if handle is not None else "none"
                drawn = (np.abs(shown - _rgb([face])[0]).max(axis=1) < 0.02).any()
            if not drawn:
                words.append(text.get_text())
    return words


def _line_is_drawn(handle: Line2D, lines: list[Line2D]) -> bool:
    """Whether lines of its colour have its dash and its marker, on one line or on two."""
    alike = [line for line in lines if same_color(line.get_color(), handle.get_color())]
    dash, marker = _dash(handle), str(handle.get_marker())
    has_dash = dash == "none" or dash in {_dash(line) for line in alike}
    bare = marker in {"None", "none", "", " "}
    return (
        bool(alike)
        and has_dash
        and (bare or marker in {str(line.get_marker()) for line in alike})
    )
