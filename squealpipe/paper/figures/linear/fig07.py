"""Fig. 7: where the linear stability analysis (A3) is valid, and what it misses."""

import math
from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from squealpipe.paper.figures.linear.linear_overlay import mark_figure_3
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.plotting import style
from squealpipe.study.figures.declared import report_figure

CELL_KINDS = (
    (style.Colour.white, "A3 stable, A1 loses contact"),
    (style.Colour.orange, "A3 unstable, A1 loses contact"),
    (style.Colour.light, "A3 stable, contact kept"),
    (style.Colour.black, "A3 unstable, contact kept"),
)
TITLES = {"": "as printed", "corrected/": "one sign in all models"}


def caption(found: Mapping[str, xr.Dataset]) -> str:
    """Explain the tones, with the numbers of cells."""
    maps = _maps(found)
    several = "; ".join(
        f"({letter}) {TITLES[_kind(name)]}"
        for letter, name in zip("ab", maps, strict=False)
    )
    growing = _listed(np.count_nonzero(grows(validity)) for validity in maps.values())
    lines = [
        _inside(found, _kind(name))
        for name in maps
        if f"{_kind(name)}validity_boundary" in found
    ]
    blue_lines = (
        "the boundary of kept contact as curves; the share of all angles that it encloses, and the "
        "distance of the cross from it:"
    )
    both = [f"{lines[0]} in both panels"] if len({*lines}) < len(lines) else lines
    blue = f" Blue: {blue_lines} {_listed(both)}." if lines else ""
    return (
        f"Where the linear model A3 is valid{f': {several}' if len(maps) > 1 else ''}. White: A1, "
        "started at rest, loses contact although A3 is stable; orange: it does and A3 is unstable. "
        "Grey: contact is kept and A3 is stable; black: kept and unstable by the eigenvalues of "
        "A3, as the paper's text says. By A1's own response, as its caption says (|x| grows "
        f"{WordsInNumbers.growth_threshold:g} times or more from the first half of the run to "
        f"the second), "
        f"{growing} of the cells that keep contact are unstable. Numbers of cells, each judged by "
        f"its run, are in the titles and the key.{blue}"
    )


def _inside(found: Mapping[str, xr.Dataset], kind: str) -> str:
    """Return the share that the boundary encloses and the distance of the scene, as text."""
    boundary, scene = (
        found[f"{kind}validity_boundary"],
        found[f"{kind}validity_distance/F3"],
    )
    share = 100.0 * float(boundary.kept_share)
    error = 100.0 * float(boundary.kept_share_error)
    digits = max(0, -math.floor(math.log10(error))) if error > 0.0 else 2
    return (
        f"{share:.{digits}f} ± {error:.{digits}f} % and "
        f"{np.degrees(float(scene.distance)):.2g}°"
    )


def kinds_of_cells(validity: xr.Dataset) -> np.ndarray:
    """Index into ``CELL_KINDS`` of each cell."""
    unstable = validity.regime_linear.values > 0
    return np.asarray(2 * (validity.separates.values == 0) + unstable)


def grows(validity: xr.Dataset) -> np.ndarray:
    """Cells that keep contact and grow by A1's own response."""
    growth = np.nan_to_num(validity.response_growth.values)
    return np.asarray(
        (validity.separates.values == 0) & (growth >= WordsInNumbers.growth_threshold)
    )


def draw_kinds(
    panel: Axes, validity: xr.Dataset, boundary: xr.Dataset | None = None
) -> np.ndarray:
    """The four kinds of cells by their runs, orange ones hatched for reading in greyscale; beside
    them the boundary as curves.
    """
    if boundary is not None:
        angles = boundary.alpha1.values, boundary.alpha2.values
        look = {
            "color": style.Colour.blue,
            "linewidth": 0.5,
            "label": "boundary of kept contact",
        }
        style.draw_lines(panel, angles, boundary.curve.values, **look)
    kinds = kinds_of_cells(validity)
    style.draw_map(
        panel,
        validity,
        kinds,
        **style.category_colours([tone for tone, _ in CELL_KINDS]),
    )
    style.hatch(panel, validity, kinds == 1)
    return kinds


def key() -> list[Patch]:
    """Return the legend entries of the four tones."""
    patches = style.patches(CELL_KINDS)
    patches[1].set_hatch(style.HATCH)
    return patches


@report_figure(
    reads=("[cv]*alidity_[bdm]*",),
    caption=caption,
    alt=(
        "Maps over both angles in white, orange, grey and black, with the boundary of kept contact."
    ),
)
def draw(found: Mapping[str, xr.Dataset]) -> Figure:
    """One map, and beside it that of friction of one sign if the study has it.

    Args:
        found: dataset ``validity_map``, and ``corrected/validity_map``, and as ``contact_boundary``
            the boundary in each.
    """
    maps = _maps(found)
    size = (
        (6.4, 4.0) if len(maps) > 1 else (4.3, 3.9)
    )  # for text large enough on page one
    figure, axes = style.new_figure(*size, text=1.36, ncols=len(maps))
    counts = []
    for panel, letter, name in zip(axes[0], "ab", maps, strict=False):
        kinds = draw_kinds(
            panel, maps[name], found.get(f"{_kind(name)}validity_boundary")
        )
        mark_figure_3(panel)
        counts.append(np.bincount(kinds.ravel(), minlength=len(CELL_KINDS)))
        words = TITLES[_kind(name)].removesuffix(" in all models")
        title = f"{words}: " if len(maps) > 1 else ""
        style.panel_letter(panel, letter, f"{title}{counts[-1][3]} black cells")
    handles = key()
    for index, handle in enumerate(handles):
        numbers = " | ".join(str(count[index]) for count in counts)
        handle.set_label(f"{handle.get_label()}: {numbers}")
    marks = axes[0, 0].get_legend_handles_labels()[0]
    figure.legend(handles=[*handles, *marks], loc="outside lower center", ncols=2)
    return figure


def _maps(found: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Return the maps, by name, in the order of their panels."""
    names = [f"{kind}validity_map" for kind in TITLES]
    return {name: found[name] for name in names if name in found}


def _kind(name: str) -> str:
    return name.removesuffix("validity_map")


def _listed(counts: object) -> str:
    return " and ".join(map(str, counts))  # type: ignore[call-overload]
