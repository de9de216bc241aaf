"""Periodic motions: one cycle, branches of cycles, backbones."""

from collections.abc import Iterable

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from squealpipe.codes import flag_words
from squealpipe.parameters import TABLE
from squealpipe.plotting import style
from squealpipe.plotting.origin import parameter, slip_along_belt
from squealpipe.plotting.quantities import label
from squealpipe.schema import meanings


def draw_backbone(axes: Axes, branch: xr.Dataset) -> None:
    """Peak of y and amplitude of x over the frequency; open marks are unstable."""
    if say_why_empty(axes, branch):
        return
    unstable = np.abs(branch.stability_index.values) > 2
    for values, colour, dash, words in (
        (branch.y_peak, style.Colour.across, "-", "y peak"),
        (branch.x_amplitude, style.Colour.along, "--", "x amplitude"),
    ):
        axes.plot(branch.omega, values, color=colour, linestyle=dash, label=words)
        axes.plot(
            branch.omega[unstable],
            values[unstable],
            linestyle="none",
            marker="o",
            markerfacecolor="white",
            markeredgecolor=colour,
            markersize=3,
        )
    style.preload_line(axes, parameter(branch, "preload"))
    axes.set(xlabel="ω (rad/s)", ylabel="displacement (m)", ylim=(0, None))
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, borderaxespad=0)


def draw_cycle(axes: Axes, cycle: xr.Dataset) -> None:
    """Path of the mass along a cycle, its regimes coloured; or why there is none.

    Of an orbit of A4 the colours say where it is in contact.
    """
    axes.set(xlabel="x (m)", ylabel="y (m)")
    if say_why_empty(axes, cycle):
        return
    x = cycle.x_path.values
    y = cycle.y_path.values
    preload = parameter(cycle, "preload")
    if "regime_path" in cycle:
        draw_regimes(axes, x, y, cycle)
    else:
        for part, colour, words in (
            (y > preload, style.Colour.red, "separated"),
            (y <= preload, style.Colour.blue, "contact"),
        ):
            axes.plot(x, np.where(joined(part), y, np.nan), color=colour, label=words)
    style.preload_line(axes, preload)
    axes.set(aspect="equal", adjustable="datalim")
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, ncols=2)


def draw_regimes(axes: Axes, x: np.ndarray, y: np.ndarray, cycle: xr.Dataset) -> None:
    """A line along a cycle in the colours of its regimes."""
    flags = meanings(cycle.regime_path)
    regimes = slip_along_belt(cycle.regime_path.values, parameter(cycle, "belt_speed"))
    for value in np.unique(regimes):
        name = flags[int(value)]
        drawn = np.where(joined(regimes == value), y, np.nan)
        words = name.replace("_", ", ")
        axes.plot(
            x, drawn, color=style.REGIME_COLOURS[name], linewidth=1.4, label=words
        )


def draw_branch(axes: Axes, branch: xr.Dataset) -> None:
    """Largest size of the first state over the parameter, with special points."""
    if say_why_empty(axes, branch):
        return
    followed = branch[branch.attrs["parameter"]]
    state = next(name for name in map(str, branch.data_vars) if name.endswith("_max"))[
        :-4
    ]
    trace_branch(axes, followed.values, largest(branch, state), branch)
    units = branch[f"{state}_max"].units
    words, name = label(followed).replace(" along the branch", ""), str(followed.name)
    if name in TABLE:
        words = words.replace(name, style.symbol(name), 1)
    axes.set(xlabel=words, ylabel=f"largest |{state}| ({units})")
    axes.legend(*key_entries([axes]))


def largest(branch: xr.Dataset, state: str) -> np.ndarray:
    """Largest absolute value of a state along each cycle."""
    ends = [np.abs(branch[f"{state}_{end}"].values) for end in ("min", "max")]
    return np.asarray(np.maximum(*ends))


def trace_branch(
    axes: Axes, parameters: np.ndarray, sizes: np.ndarray, branch: xr.Dataset
) -> None:
    """Draw one branch as lines of two looks, with its special points, all with labels."""
    if branch.sizes["point"] < 2:
        return
    stable = branch.stable.values.astype(bool)
    # the line between two points is unstable if either is
    steady = stable[:-1] & stable[1:]
    ends = np.flatnonzero(np.diff(steady)) + 1
    for piece in np.split(np.arange(len(steady)), ends):
        colour, dash, words = (
            (style.Colour.blue, "-", "stable")
            if steady[piece[0]]
            else (style.Colour.orange, "--", "unstable")
        )
        points = slice(piece[0], piece[-1] + 2)
        axes.plot(
            parameters[points], sizes[points], dash, color=colour, lw=1.2, label=words
        )
    # marker, colour and words of each
    special_point_marks = {
        "fold": ("^", style.Colour.red, "fold"),
        "period_doubling": ("s", style.Colour.purple, "period doubling"),
        "torus": ("D", style.Colour.green, "torus bifurcation"),
        "grazing": ("o", style.Colour.black, "grazing"),
        "stick_onset": ("v", style.Colour.green, "stick just begins or ends"),
    }
    for value, name in meanings(branch.label).items():
        points = branch.label.values == value
        if name in special_point_marks and points.any():
            marker, colour, words = special_point_marks[name]
            sites = parameters[points], sizes[points]
            axes.plot(*sites, marker, color=colour, markersize=4, zorder=4, label=words)


def key_entries(panels: Iterable[Axes]) -> tuple[list[Artist], list[str]]:
    """Each label once, over all panels."""
    entries: dict[str, Artist] = {}
    for panel in panels:
        for handle, words in zip(*panel.get_legend_handles_labels(), strict=True):
            entries.setdefault(words, handle)
    return list(entries.values()), list(entries)


def joined(chosen: np.ndarray) -> np.ndarray:
    """Chosen points and the next one on either side, so that no line gapes where looks change."""
    near = chosen.copy()
    near[1:] |= chosen[:-1]
    near[:-1] |= chosen[1:]
    return near


def say_why_empty(axes: Axes, motions: xr.Dataset) -> bool:
    """Write into the panel why no cycle or branch was found; return whether it is empty."""
    branch = "point" in motions.sizes
    if motions.sizes["point" if branch else "sample"]:
        return False
    why = motions.end if branch else motions.outcome
    reason = flag_words(meanings(why)[int(why)])
    style.say_instead(axes, f"no periodic motion:\n{reason}")
    return True
