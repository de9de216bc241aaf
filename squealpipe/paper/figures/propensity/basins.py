"""Kind of motion over the velocity at the start, in two scenes."""

import xarray as xr
from matplotlib.figure import Figure

from squealpipe.codes import flag_words
from squealpipe.plotting import style
from squealpipe.plotting.origin import scene_title
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("basin/F2d", "basin/F3"),
    caption=(
        "Kind of motion that starts from r = 0 with a velocity lead to. (a) Scene of Fig. 2(d), "
        "(b) scene of Fig. 3. Each label is that of the second half of the run; white: its "
        "quarters have different ones, so the run has not settled."
    ),
    alt="Two maps over the velocity at the start, coloured by the kind of motion.",
)
def draw(kept: xr.Dataset, growing: xr.Dataset) -> Figure:
    """Two maps."""
    figure, axes = style.new_figure(style.PAGE, 3.5, ncols=2)
    shown: set[int] = set()
    names = str(kept.motion.attrs["flag_meanings"]).split()
    colours = [style.REGIME_COLOURS.get(name, style.Colour.white) for name in names]
    titles = (scene_title("F2d"), scene_title("F3"))
    for letter, panel, basin, title in zip(
        "ab", axes[0], (kept, growing), titles, strict=True
    ):
        panel.pcolormesh(
            basin.vx0,
            basin.vy0,
            basin.motion.values.T,
            shading="nearest",
            rasterized=True,
            **style.category_colours(colours),
        )
        shown |= set(basin.motion.values.ravel().tolist())
        panel.set(xlabel="velocity along the belt (m/s)", aspect="equal")
        style.panel_letter(panel, letter, title)
    axes[0, 0].set_ylabel("velocity away from the belt (m/s)")
    handles = style.patches((colours[k], flag_words(names[k])) for k in sorted(shown))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=min(len(handles), 4)
    )
    return figure
