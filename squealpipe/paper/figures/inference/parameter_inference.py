"""Extra figure: the parameters that agree with the paper's statements."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from squealpipe.paper.schema.inference import in_order, in_words, of_study
from squealpipe.plotting import style
from squealpipe.study.figures.declared import report_figure
from squealpipe.systems.inputs.words import number

READING_LOOKS = (
    ("as printed", style.Colour.green, "s"),
    ("along +x", style.Colour.blue, "o"),
    ("along −x", style.Colour.orange, "^"),
)
"""Label, colour and marker of each reading."""


def caption(inference: xr.Dataset) -> str:
    """Explain the marks, and name the readings without a feasible set."""
    counts = in_order(inference).feasible_count.values
    pairs = zip(READING_LOOKS, counts, strict=True)
    empty = " or ".join(label for (label, *_), count in pairs if not count)
    return (
        "Parameters inferred from the paper's own statements. (a)–(c) Samples in which all "
        "statements hold, in each reading of the sign of friction, over the sampled ranges"
        f"{f' (none {empty})' if empty else ''}; star: this study, by its spring 1; above the "
        "dashed line in (a), μ = cot 0.4π, the linear models dragged along +x are unstable at the "
        "angles of Fig. 3. (d) Share of the samples that each statement alone excludes, by "
        "reading; no bar: none. (e) Margins of the study's own parameters in its reading: "
        "positive where the statement holds, cut at −1."
    )


@report_figure(
    reads=("parameter_inference",),
    caption=caption,
    alt=(
        "Three scatter plots of feasible parameters and two bar charts over the paper's statements."
    ),
)
def draw(inference: xr.Dataset) -> Figure:
    """Five panels, from dataset ``parameter_inference``."""
    inference = in_order(inference)
    figure, _ = style.new_figure(style.PAGE, 5.4)
    figure.clear()
    grid = figure.add_gridspec(2, 1, height_ratios=(1.15, 1))
    upper, lower = figure.add_subfigure(grid[0]), figure.add_subfigure(grid[1])
    panels = (
        ("friction, stiffness", "kappa", "mu", "κ = k₃/k", "μ"),
        (
            "stiffness, length",
            "length_ratio",
            "kappa",
            r"λ = $L/l_\mathrm{pre}$",
            "κ = k₃/k",
        ),
        (
            "belt speed, length",
            "length_ratio",
            "speed_ratio",
            r"λ = $L/l_\mathrm{pre}$",
            r"v = $V/(l_\mathrm{pre}\sqrt{k/m})$",
        ),
    )
    for panel, letter, (title, *names) in zip(
        upper.subplots(1, 3), "abc", panels, strict=True
    ):
        _scatter(panel, inference, *names)
        style.panel_letter(panel, letter, title)
        if letter == "a":
            panel.axhline(
                1 / np.tan(0.4 * np.pi), color=style.Colour.grey, ls="--", lw=0.8
            )
    upper.legend(
        *panel.get_legend_handles_labels(), loc="outside lower center", ncols=3
    )
    shares, margins = lower.subplots(1, 2, sharey=True)
    places = np.arange(inference.sizes["statement"])
    for row, (label, colour, _) in enumerate(READING_LOOKS):
        alone = 100 * inference.share_cut_alone.values[row]
        shares.barh(
            places + 0.27 * (row - 1), alone, color=colour, height=0.25, label=label
        )
    shares.set_yticks(places, map(in_words, inference.statement.values))
    shares.invert_yaxis()
    # readings differ by powers of ten, and one without any would look like one with few
    # per cent: below one sample of 20,480
    shares.set(xlabel="share of the samples, %", xscale="log", xlim=(1e-3, 100.0))
    shares.xaxis.set_major_formatter("{x:g}")
    lower.legend(
        *shares.get_legend_handles_labels(), loc="outside lower center", ncols=3
    )
    style.panel_letter(shares, "d", "excluded by one alone")
    values = np.maximum(of_study(inference).baseline_margin.values, -1.0)
    bars = margins.barh(
        places,
        values,
        color=np.where(values > 0, style.Colour.green, style.Colour.orange),
    )
    margins.bar_label(bars, [number(value, 2) for value in values], padding=3, size=6)
    margins.axvline(0, color=style.Colour.black, lw=0.6)
    margins.set(xlabel="margin at the study's parameters")
    style.panel_letter(margins, "e", "margins of this study")
    return figure


def _scatter(
    panel: Axes, inference: xr.Dataset, x: str, y: str, x_label: str, y_label: str
) -> None:
    for row, (label, colour, marker) in enumerate(READING_LOOKS):
        one = inference.isel(reading=row)
        chosen = one.feasible.values == 1
        if not chosen.any():
            continue
        panel.plot(
            one[x].values[chosen],
            one[y].values[chosen],
            marker,
            ms=2.6,
            mew=0.5,
            mfc="none",
            color=colour,
            label=f"{label} ({int(one.feasible_count)})",
        )
    own = [abs(float(inference[f"baseline_{name}"])) for name in (x, y)]
    panel.plot(
        *own,
        "*",
        ms=9,
        mew=0.8,
        mfc="white",
        color=style.Colour.black,
        label="this study",
    )
    for name, axis, scale, limits in (
        (x, panel.xaxis, panel.set_xscale, panel.set_xlim),
        (y, panel.yaxis, panel.set_yscale, panel.set_ylim),
    ):
        if name in ("length_ratio", "speed_ratio"):
            scale("log")
            axis.set_major_locator(
                LogLocator(subs=(1.0, 2.0, 5.0) if name == x else (1.0,))
            )
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())
        values = inference[name].values
        limits(values.min(), values.max())
    panel.set(xlabel=x_label, ylabel=y_label)
