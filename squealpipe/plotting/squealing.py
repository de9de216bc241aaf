"""Pictures of a structure's squeal: growth of the modes over frequency, bars of its attractors."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from squealpipe.plotting import style
from squealpipe.plotting.hysteresis import draw_hysteresis, has_tracks
from squealpipe.plotting.modes import draw_stability, frequency_unit, show_what_grows
from squealpipe.structures.schema.squealing import Kind
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number

BARS_HEIGHT = 0.8
"""Height of all bars of one attractor together, over the distance between attractors."""


def figure(answer: xr.Dataset) -> Figure:
    """Draw growth over frequency; then share, level and contact loss of each attractor.

    A panel below shows motions over falling friction, if the dataset has them.
    """
    # six attractors fit; they are sorted by the number of random starts that settle on them
    shown = with_most_contact_loss(answer.isel(attractor=slice(6)))
    count = max(shown.sizes["attractor"], 1)
    height = 2.6 + 0.12 * count * shown.sizes["contact"] * (count > 1)
    height, ratios = min(height, 6.0), [1.7, 1.0, 1.0, 1.2]
    followed = has_tracks(answer)
    over_friction = 2.2  # inches: height of the panel over friction
    layout: dict[str, Any] = (
        {"nrows": 2, "height_ratios": [height, over_friction]} if followed else {}
    )
    made, axes = style.new_figure(
        style.PAGE,
        height + over_friction * followed,
        ncols=4,
        width_ratios=ratios,
        **layout,
    )
    made.get_layout_engine().set(w_pad=0.08)  # type: ignore[union-attr, call-arg]
    poles, shares, levels, losses = axes[0]
    _poles(poles, answer)
    made.legend(*poles.get_legend_handles_labels(), loc="outside lower left", ncols=3)
    draw_shares(shares, shown)
    _bars(levels, shown.velocity_rms.values)
    levels.set(xlabel="rms speed (m/s)")
    if not shown.velocity_rms.values.any():
        levels.set(xlim=(0.0, 1.0))
    _losses(losses, shown)
    for axes_ in (levels, losses):
        axes_.set_yticks(np.arange(shown.sizes["attractor"]), [])
    for axes_ in (shares, levels, losses):  # few and short: the panels are narrow
        if len(axes_.get_xticks()):
            axes_.xaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
            axes_.xaxis.set_major_formatter(FuncFormatter(lambda x, _: number(x, 3)))
    titles = ("what grows", "ends in", "how loud", "contact loss")
    style.panel_letters(axes[0], titles)
    if followed:
        grid = axes[1, 0].get_gridspec()
        for panel in axes[1]:
            panel.remove()
        over = made.add_subplot(grid[1, :])
        draw_hysteresis(over, answer)
        style.panel_letter(over, "e", "as friction falls")
    return made


def with_most_contact_loss(answer: xr.Dataset) -> xr.Dataset:
    """Return the contacts whose names can be read beside their bars: those that open most."""
    most = 6
    if answer.sizes["contact"] <= most or not answer.sizes["attractor"]:
        return answer
    opened = answer.separated_fraction.max("attractor").values
    return answer.isel(contact=np.sort(np.argsort(-opened, kind="stable")[:most]))


def draw_poles(axes: Axes, answer: xr.Dataset) -> None:
    """Growth over frequency as eigenvalue codes draw it; dashed, where the motions ring."""
    _poles(axes, answer)
    axes.legend()


def _poles(axes: Axes, answer: xr.Dataset) -> None:
    # modes whose error is not known, beyond the band of a large structure, are left out
    answer = answer.isel(pole=answer.pole_growth_rate_error.notnull().values)
    frequencies = answer.pole_frequency.values
    factor, unit = frequency_unit(frequencies)
    frequency, growth = frequencies * factor, answer.pole_growth_rate
    unstable = np.isin(answer.pole.values, answer.mode.values)
    _errors(axes, answer, factor)
    limit = float(answer.frequency_max)
    if frequencies.max(initial=0.0) > limit:
        axes.axvspan(
            limit * factor,
            1.05 * frequencies.max() * factor,
            color=style.Colour.grey,
            alpha=0.2,
            linewidth=0,
            label="beyond the band",
        )
    for index, ring in enumerate(answer.dominant_frequency.values * factor):
        if np.isfinite(ring):
            label = None if index else "strongest line"
            axes.axvline(
                ring,
                color=style.Colour.black,
                linewidth=0.8,
                linestyle="--",
                label=label,
            )
    draw_stability(axes, frequency, growth.values, unstable)
    shown = growth.values
    if answer.sizes["missing"]:
        lost = answer.missing_growth_rate.values
        shown = np.concatenate([shown, lost])
        at = answer.missing_frequency.values * factor
        axes.plot(
            at,
            lost,
            "D",
            ms=4,
            mfc="none",
            color=style.Colour.red,
            label="missing in the run",
        )
    show_what_grows(axes, shown)
    axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.margins(x=0.08)
    axes.set(xlabel=f"frequency ({unit})", ylabel="growth rate (1/s)")


def _errors(axes: Axes, answer: xr.Dataset, factor: float) -> None:
    """Bars from each mode's place to that of the whole structure's, where both are apart."""
    if not float(answer.growth_rate_error):
        return
    axes.errorbar(
        answer.pole_frequency.values * factor,
        answer.pole_growth_rate.values,
        answer.pole_growth_rate_error.values,
        answer.pole_frequency_error.values * factor,
        fmt="none",
        ecolor=style.Colour.grey,
        elinewidth=0.8,
        label="error of the modes kept",
    )


def draw_shares(axes: Axes, answer: xr.Dataset) -> None:
    """Share of the random starts that end in each attractor, with its interval."""
    if not answer.sizes["attractor"]:
        style.say_instead(axes, "no start settled")
        return
    share = answer.share.values
    ends = np.stack([answer.share_low.values, answer.share_high.values])
    _bars(axes, share, xerr=np.abs(ends - share))
    axes.set_yticks(np.arange(len(share)), _names(answer))
    axes.set(xlabel="share of starts", xlim=(0, 1.02))


def _names(answer: xr.Dataset) -> list[str]:
    """Each attractor by its frequency and kind."""
    words = [Kind(int(value)).words for value in answer.kind.values]
    return [
        word.replace(" ", "\n")
        if np.isnan(frequency)
        else f"{engineering(frequency, 'Hz', 4)}\n{word}"
        for word, frequency in zip(words, answer.dominant_frequency.values, strict=True)
    ]


def _losses(axes: Axes, answer: xr.Dataset) -> None:
    """Share of time without contact, a bar for each contact from the first one down."""
    names = answer.contact.values.tolist()
    separated = answer.separated_fraction.values
    step = BARS_HEIGHT / len(names)
    for index, name in enumerate(names):
        at = np.arange(len(separated)) + (index + 0.5) * step - 0.5 * BARS_HEIGHT
        axes.barh(
            at, separated[:, index], 0.8 * step, color=style.Colour.orange, **_EDGE
        )
        for row, value in zip(at, separated[:, index], strict=True):
            axes.annotate(
                name,
                (value, row),
                (2, 0),
                textcoords="offset points",
                va="center",
                fontsize=min(7.0, 60.0 * step),
            )
    # a single attractor gets the room of two, or its bar would fill the panel
    room = max(0.0, 0.5 * (2 - len(separated)))
    axes.set_ylim(len(separated) - 0.5 + room, -0.5 - room)
    axes.set(
        xlabel="share of time", xlim=(0, 1.15 * max(separated.max(initial=0), 0.1))
    )


_EDGE: dict[str, Any] = {"edgecolor": style.Colour.black, "linewidth": 0.4}


def _bars(axes: Axes, values: np.ndarray, **error: Any) -> None:
    axes.barh(
        np.arange(len(values)),
        values,
        0.6 * BARS_HEIGHT,
        color=style.Colour.blue,
        ecolor=style.Colour.black,
        **_EDGE,
        **error,
    )
    room = max(0.0, 0.5 * (2 - len(values)))
    axes.set_ylim(len(values) - 0.5 + room, -0.5 - room)
