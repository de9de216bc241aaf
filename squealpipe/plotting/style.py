"""One look for every figure: sizes, colours, angle axes, and how files are written."""

import io
import math
import os
import struct
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from string import ascii_lowercase
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.ticker import ScalarFormatter

from squealpipe.parameters import TABLE
from squealpipe.plotting.text_layouts import laid_out_once
from squealpipe.store.whole_files import whole_file
from squealpipe.systems.inputs.words import as_people_write


class Colour:
    """Colours of all figures, one for each meaning.

    Attributes:
        palette: Okabe–Ito: distinct for colour-blind readers; lines also differ in dash or marker.
        white, light, black: the paper's three tones.
        along, across: displacements along the belt and away from it, everywhere.
    """

    palette = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#7F7F7F")
    blue, orange, green, red, purple, grey = palette
    white, light, black = "#FFFFFF", "#BDBDBD", "#1A1A1A"
    along, across = orange, blue


COLUMN = 3.5
PAGE = 7.0
"""Widths of one column and of a page, inches."""

POWER_OF_TEN_BELOW = 1e-3
"""Largest number on an axis whose labels are written with a power of ten."""

white_halo = [withStroke(linewidth=2, foreground="white")]
"""White border around words and marks on a map."""
HATCH = "//////"

ANGLE_NAMES = ("alpha1", "alpha2")
REGIME_COLOURS = {
    "slip_slower": Colour.blue,
    "slip_faster": Colour.green,
    "stick": Colour.orange,
    "separated": Colour.red,
    "contact_kept": Colour.blue,
    "stick_slip": Colour.orange,
    "periodic_hammering": Colour.green,
    "quasi_periodic_hammering": "#004D3A",  # dark: apart from whirl without colour too
    "undetermined": "#B8E3D4",
    "at_rest": "#9ECAE1",
    "hammered_then_contact": "#DEC24A",
    "unsettled": Colour.white,
    "rest": "#9ECAE1",
    "cycle": Colour.green,
    "irregular_hammering": Colour.red,
    "whirl": Colour.purple,
    "undecided": Colour.grey,
    "quiet": Colour.white,
    "squeals": Colour.orange,
    "hammers": Colour.red,
    "stable": Colour.white,
    "flutter": Colour.black,
    "divergence": Colour.red,
}
"""One colour for one regime, everywhere."""

SETTINGS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "mathtext.fontset": "dejavusans",
    "svg.fonttype": "path",
    "svg.hashsalt": "squealpipe",
    "figure.dpi": 100,
    "savefig.dpi": 200,
}


def new_figure(
    width: float = PAGE, height: float = 3.0, *, text: float = 1.0, **subplots: object
) -> tuple[Figure, np.ndarray]:
    """A figure with the house style, and its axes as a 2-D array.

    Args:
        text: size of all its texts over that of the house, for a figure that is printed small.
    """
    mpl.rcParams.update(SETTINGS)
    sizes = {name for name in SETTINGS if name.endswith("size")}
    mpl.rcParams.update({name: text * SETTINGS[name] for name in sizes})
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(squeeze=False, **subplots)  # type: ignore[call-overload]
    return figure, axes


def angle_ticks(axis: object, upper: float = np.pi, step: float = np.pi / 4) -> None:
    """Label an axis (``axes.xaxis`` or ``axes.yaxis``) in multiples of π."""
    ticks = np.arange(0, upper + step / 2, step)
    axis.set_ticks(ticks, [pi_label(value) for value in ticks])  # type: ignore[attr-defined]


def pi_label(angle: float) -> str:
    """An angle as the paper writes it: 0, π/4, 5π/6, 0.4π, 0.83π."""
    over_pi = angle / np.pi
    for denominator in (1, 2, 3, 4, 6):
        numerator = round(over_pi * denominator)
        if abs(over_pi * denominator - numerator) < 1e-9:
            if numerator == 0:
                return "0"
            head = "" if numerator == 1 else str(numerator)
            return f"{head}π" + ("" if denominator == 1 else f"/{denominator}")
    return f"{over_pi:.4g}π"


def angle_in_words(name: str, angle: float) -> str:
    """A title's words for one of the spring angles."""
    return f"{symbol(name)} = {pi_label(angle)}"


def symbol(name: str) -> str:
    """A parameter or an angle by its symbol: k₁, μ, α₂, l_pre."""
    known = TABLE[name].symbol if name in TABLE else f"{name[:-1]}_{name[-1]}"
    head, _, foot = known.replace('"', "").partition("_")
    subscripts = str.maketrans("0123s", "₀₁₂₃ₛ")
    below = foot.translate(subscripts) if len(foot) < 2 else f"_{foot}"
    greek = {"alpha": "α", "mu": "μ", "sigma": "σ"}
    return greek.get(head, head) + below


def symbols(text: str) -> str:
    """Names of quantities and powers of ten in plain text as mathematics, for Matplotlib."""
    for name, symbol in (
        ("l_pre", r"l_\mathrm{pre}"),
        ("N_h", r"N_\mathrm{h}"),
        ("ω_x", r"\omega_x"),
    ):
        text = text.replace(name, f"${symbol}$")
    return as_people_write(text)


def draw_map(
    axes: Axes, dataset: xr.Dataset | xr.DataArray, values: Any, **kwargs: Any
) -> Any:
    """Draw values over the dataset's angles in colours, α1 on x and α2 on y.

    Even angles make an image, which takes less time than a mesh, others a mesh, rasterized in SVG.
    """
    x, y = dataset.alpha1.values, dataset.alpha2.values
    rows = np.asarray(values).T
    if all(a.size > 1 and np.ptp(np.diff(a)) < 1e-9 * np.ptp(a) for a in (x, y)):
        half = 0.5 * np.array([x[1] - x[0], y[1] - y[0]])[:, None] * [-1.0, 1.0]
        ends = np.array([x[[0, -1]], y[[0, -1]]]) + half
        (left, right), (bottom, top) = ends.tolist()
        mesh: Any = axes.imshow(
            rows,
            origin="lower",
            extent=(left, right, bottom, top),
            interpolation="nearest",
            **kwargs,
        )
    else:
        mesh = axes.pcolormesh(x, y, rows, shading="nearest", rasterized=True, **kwargs)
    for axis in (axes.xaxis, axes.yaxis):
        angle_ticks(axis, float(x[-1]))
    axes.set(xlabel="α₁ (rad)", ylabel="α₂ (rad)", aspect="equal")
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    axes.spines[["top", "right"]].set_visible(True)
    return mesh


def draw_lines(
    axes: Axes, lines: Sequence[np.ndarray], curve: np.ndarray, **look: Any
) -> None:
    """Lines, (x, y), with a gap wherever another curve begins."""
    ends = np.flatnonzero(np.diff(curve)) + 1
    axes.plot(*(np.insert(line, ends, np.nan) for line in lines), **look)


def hatch(axes: Axes, dataset: xr.Dataset, mask: np.ndarray) -> None:
    """Hatch cells (alpha1, alpha2) of a map, which greyscale shows too."""
    if mask.any():
        angles = dataset.alpha1.values, dataset.alpha2.values
        cells = mask.T.astype(float)
        axes.contourf(*angles, cells, levels=[0.5, 1.5], colors="none", hatches=[HATCH])


def patches(tones: Iterable[tuple[Any, str]], **look: Any) -> list[Patch]:
    """Entries of a legend: colour and words."""
    look = {"edgecolor": Colour.black, "linewidth": 0.5, **look}
    return [Patch(facecolor=colour, label=words, **look) for colour, words in tones]


def colour_of(entry: Any) -> str:
    """Return the colour of this palette that an entry of an enumeration names."""
    return str(getattr(Colour, entry.colour))


def category_colours(colours: Sequence[Any]) -> dict[str, Any]:
    """``cmap`` and ``norm`` that paint the integers 0, 1, … with the given colours."""
    bounds = np.arange(len(colours) + 1) - 0.5
    return {
        "cmap": ListedColormap(list(colours)),
        "norm": BoundaryNorm(bounds, len(colours)),
    }


def panel_letter(axes: Axes, letter: str, text: str = "") -> None:
    """(a), (b), … at the left above a panel, with an optional title."""
    axes.set_title(f"({letter}) {text}".rstrip(), loc="left")


def panel_letters(panels: Iterable[Axes], titles: Iterable[str]) -> None:
    """(a), (b), … and the title of each panel; panels without a title have none."""
    for letter, panel, title in zip(ascii_lowercase, panels, titles, strict=False):
        panel_letter(panel, letter, title)


def write(axes: Axes, x: float, y: float, text: str, **look: Any) -> None:
    """A text with its middle at a place."""
    axes.text(x, y, text, ha="center", va="center", **look)


def say_instead(axes: Axes, text: str) -> None:
    """Write into a panel why it would be empty."""
    write(axes, 0.5, 0.5, text, transform=axes.transAxes, wrap=True)
    axes.set(xticks=[], yticks=[])


def preload_line(axes: Axes, preload: float) -> None:
    """A dotted line at l_pre, above which contact is lost, named at its right end."""
    axes.axhline(preload, color=Colour.grey, linewidth=0.8, linestyle=":")
    axes.annotate(
        r"$l_\mathrm{pre}$",
        (1, preload),
        xycoords=("axes fraction", "data"),
        xytext=(2, 0),
        textcoords="offset points",
        va="center",
        color=Colour.grey,
        fontsize=7,
    )


def shorten_small_ticks(figure: Figure) -> None:
    """A power of ten beside each axis below 0.001, whose labels would run into one another."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            ticks = axis.get_major_formatter()
            small = np.abs(axis.get_view_interval()).max() < POWER_OF_TEN_BELOW
            if small and isinstance(ticks, ScalarFormatter):
                ticks.set_useMathText(True)
                ticks.set_powerlimits((-3, 5))


def _resize(figure: Figure, size: tuple[float, float]) -> None:
    """Give a figure another size, with smaller texts where it shrinks.

    Raises:
        ValueError: several panels would have texts that nobody can read.
    """
    width, height = figure.get_size_inches()
    share = min(1.0, size[0] / width, size[1] / height)
    smallest = 0.72  # 6 of 8 points: smaller text cannot be read in print
    if share < smallest and len(figure.axes) > 1:
        asked, needed = (
            "mmx".join(str(math.ceil(25.4 * side - 1e-6)) for side in sides) + "mm"
            for sides in (size, (smallest * width, smallest * height))
        )
        raise ValueError(
            f"figure size {asked}: too small for {len(figure.axes)} panels; give {needed} or "
            "more, or draw one quantity with `squealpipe plot FILE --variable NAME`"
        )
    share = max(share, smallest)
    for words in figure.findobj(Text):
        words.set_fontsize(share * words.get_fontsize())  # type: ignore[attr-defined]
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            ticks = axis.get_ticklabels()
            if ticks:
                axis.set_tick_params(labelsize=ticks[0].get_fontsize())
    figure.set_size_inches(size)
    if any(axes.get_aspect() != "auto" for axes in figure.axes):
        figure.set_layout_engine("compressed")  # a map in the middle of a wide picture


@laid_out_once()
def save_figure(
    figure: Figure,
    paths: Sequence[str | os.PathLike[str]],
    *,
    size: tuple[float, float] | None = None,
    dpi: int | None = None,
) -> None:
    """Write a figure to every path, atomically and without a date: equal inputs, equal files.

    The layout is found once, at the resolution of the first file: left to ``savefig``, each file
    would be drawn twice.

    Args:
        size: width and height in inches, those of the figure by default.
    """
    shorten_small_ticks(figure)
    dots = dpi or mpl.rcParams["savefig.dpi"]
    if not 20 <= dots <= 2400:
        raise ValueError(f"dpi = {dots}: from 20 to 2400 dots per inch are possible")
    if size is not None:
        _resize(figure, size)
    figure.set_dpi(dots)
    # layout and PNG share what it measures of texts
    canvas: Any = FigureCanvasAgg(figure)
    if (engine := figure.get_layout_engine()) is not None:
        engine.execute(figure)
        figure.set_layout_engine(None)
    for path in map(Path, paths):
        content = io.BytesIO()  # on a full disk a PDF is closed with an error of zlib
        if path.suffix == ".png":
            _draw_png(canvas, content)
        else:
            metadata = {"Date": None} if path.suffix == ".svg" else {}
            figure.savefig(content, format=path.suffix[1:], metadata=metadata, dpi=dots)
        with whole_file(path) as temporary:
            temporary.write_bytes(content.getvalue())


def _draw_png(canvas: Any, content: io.BytesIO) -> None:
    """Draw a figure as a PNG without transparency, which a PDF would have to take apart.

    Its lines are packed as they are. Pillow tries five filters on each, which takes longer than
    all packing, and drawings get no smaller by it.
    """
    canvas.draw()
    opaque = np.asarray(canvas.buffer_rgba())[..., :3]
    height, width, _ = opaque.shape
    # each line begins with its filter, 0
    lines = np.pad(opaque.reshape(height, -1), ((0, 0), (1, 0)))
    dots = round(canvas.figure.dpi / 0.0254)  # per metre
    content.write(b"\x89PNG\r\n\x1a\n")
    for name, data in (
        (b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)),  # 8 bits, RGB
        (b"pHYs", struct.pack(">2IB", dots, dots, 1)),
        (b"tEXt", b"Software\0squealpipe"),
        (b"IDAT", zlib.compress(lines.tobytes(), 3)),
        (b"IEND", b""),
    ):
        check = zlib.crc32(name + data)
        content.write(struct.pack(">I", len(data)) + name + data)
        content.write(struct.pack(">I", check))
