"""Draw shapes of complex modes: on the mesh, or as arrows at degrees of freedom."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from squealpipe.plotting import style
from squealpipe.plotting.mesh_scene import Facets, projection
from squealpipe.plotting.origin import common_friction
from squealpipe.structures.meshes.datasets import mesh_of
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number


def shape_of(modes: xr.Dataset, mode: int) -> np.ndarray:
    """Return the complex shape of a mode, (degrees of freedom,).

    Raises:
        ValueError: the dataset has no shapes, or none of this mode.
    """
    if "shape_real" not in modes:
        raise ValueError(
            "the dataset has no mode shapes; compute it again with this version of squealpipe"
        )
    numbers = modes.mode.values
    if mode not in numbers:
        raise ValueError(
            f"mode = {mode!r}: the dataset has modes {numbers.min()} to {numbers.max()}"
        )
    one = modes.sel(mode=mode)
    shape = one.shape_real.values.astype(float) + 1j * one.shape_imaginary.values
    if not np.isfinite(shape).all():
        raise ValueError(
            f"mode = {mode!r} has no stored shape: shapes are those of the modes that exist at "
            f"{_friction(modes)}, of a large structure the unstable and the lowest ones"
        )
    return np.asarray(shape)


def draw_shape(
    axes: Axes, modes: xr.Dataset, mode: int, *, quarter: bool = False
) -> ScalarMappable | None:
    """Draw a mode: undeformed grey, deformed coloured by how far each place moves.

    Args:
        mode: its number.
        quarter: a quarter of a period after the instant of the largest displacement.

    Returns:
        What a colour bar takes; None where there is no mesh.
    """
    shape = shape_of(modes, mode)
    moved = -shape.imag if quarter else shape.real
    mesh = mesh_of(modes)
    if mesh is None:
        _draw_arrows(axes, moved)
        return None
    nodes = mesh.displacements(moved)
    amplitude = np.linalg.norm(np.abs(mesh.displacements(shape)), axis=1)
    view = projection(mesh.nodes)
    extent = float(np.ptp(mesh.nodes, axis=0).max()) or 1.0
    # relative to the extent of the structure: large enough to be seen, small enough to keep its
    # form
    largest_deflection = 0.08
    scale = largest_deflection * extent / max(float(amplitude.max()), 1e-300)
    Facets(
        axes, mesh, view, facecolor="none", edgecolor=style.Colour.light, linewidth=0.4
    )
    drawn = Facets(axes, mesh, view, cmap="cividis", edgecolor="#404040", linewidth=0.3)
    drawn.show(mesh.nodes + scale * nodes)
    share = amplitude / max(float(amplitude.max()), 1e-300)
    drawn.drawn.set_array(np.array([share[row].mean() for row in drawn.rows]))
    drawn.drawn.set_clim(0.0, 1.0)
    flat = mesh.nodes @ view[:2].T
    low, high = (
        flat.min(axis=0) - largest_deflection * extent,
        flat.max(axis=0) + largest_deflection * extent,
    )
    axes.plot(*np.stack([low, high], axis=1), alpha=0.0)
    if "contact_position" in modes:
        places = modes.contact_position.values
        places = places[np.isfinite(places).all(axis=1)] @ view[:2].T
        axes.plot(*places.T, "o", color=style.Colour.black, markersize=2.5, zorder=5)
    axes.margins(0.02)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_axis_off()
    return drawn.drawn  # type: ignore[no-any-return]


def _draw_arrows(axes: Axes, moved: np.ndarray) -> None:
    """Arrows at the degrees of freedom, counted as files of structures count them."""
    # arrows of more degrees of freedom than this cover one another; those that move most have one
    most_arrows = 40
    chosen = np.sort(np.argsort(-np.abs(moved), kind="stable")[:most_arrows])
    places = np.arange(len(chosen))
    axes.axhline(0.0, color=style.Colour.light, linewidth=1.0)
    axes.plot(places, 0.0 * places, "o", color=style.Colour.grey, markersize=3)
    axes.quiver(
        places,
        0.0 * places,
        0.0 * places,
        moved[chosen],
        angles="xy",
        scale_units="xy",
        scale=1.0,
        color=style.Colour.blue,
        width=0.006,
    )
    labelled = places[:: -(-len(places) // 10)]  # more labels would overprint
    axes.set_xticks(labelled, [str(chosen[place] + 1) for place in labelled])
    axes.set(
        xlabel="degree of freedom, counted from 1",
        ylabel="displacement / largest",
        ylim=(-1.1, 1.1),
    )
    axes.margins(x=0.08)


def title_of(modes: xr.Dataset, mode: int) -> str:
    """Return number, frequency and growth of a mode where its shape is."""
    one = modes.sel(mode=mode)
    at = {
        dim: float(modes[f"shape_{dim}"])
        for dim in ("mu", "belt_speed")
        if dim in one.frequency.dims
    }
    one = one.sel(at, method="nearest") if at else one
    one = one.isel(dict.fromkeys(one.frequency.dims, 0))
    frequency = engineering(float(one.frequency), "Hz", 4)
    return (
        f"mode {mode}: {frequency}, growth rate {number(float(one.growth_rate))} 1/s at "
        f"{_friction(modes)}"
    )


def _friction(modes: xr.Dataset) -> str:
    """Return the friction at which the shapes are, in words."""
    at = number(float(modes.shape_mu))
    if "mu_of" in modes.attrs:
        return f"mu of {modes.attrs['mu_of']} = {at}"
    if "critical_scale" not in modes:
        return f"mu = {at}"
    # every contact has a friction of its own, and what is varied is a factor of all
    if (own := common_friction(modes)) is not None:
        return f"mu = {number(own * float(modes.shape_mu))}"
    return "the friction of each contact" if at == "1" else f"{at} times every friction"


def figure_of_mode(modes: xr.Dataset, mode: int) -> Figure:
    """Draw one mode at the instant of its largest displacement and a quarter period later."""
    made, axes = style.new_figure(style.PAGE, 2.6, ncols=2)
    for panel, quarter in zip(axes[0], (False, True), strict=True):
        coloured = draw_shape(panel, modes, mode, quarter=quarter)
    _add_colour_bar(made, axes, coloured)
    style.panel_letters(axes[0], ("largest displacement", "a quarter period later"))
    made.suptitle(title_of(modes, mode), fontsize=9)
    return made


def unstable_modes(modes: xr.Dataset, most: int) -> list[int]:
    """Return the numbers of modes that grow where shapes are, the fastest first.

    Where none grows they are those that are damped least.
    """
    if "shape_real" not in modes:
        return []
    at = {
        dim: float(modes[f"shape_{dim}"])
        for dim in ("mu", "belt_speed")
        if dim in modes.growth_rate.dims
    }
    here = modes.sel(at, method="nearest") if at else modes
    here = here.isel({dim: 0 for dim in here.growth_rate.dims if dim != "mode"})
    has_shape = np.isfinite(modes.shape_real.values).all(axis=1)
    known = np.flatnonzero(has_shape & np.isfinite(here.growth_rate.values))
    order = known[np.argsort(-here.growth_rate.values[known], kind="stable")]
    grows = [place for place in order if bool(here.unstable[place])]
    return [int(modes.mode[place]) for place in (grows or order)[:most]]


def figure_of_modes(modes: xr.Dataset) -> Figure:
    """Draw the shapes of the four modes that grow fastest, two in a row."""
    numbers = unstable_modes(modes, 4)
    rows = max(-(-len(numbers) // 2), 1)
    columns = min(max(len(numbers), 1), 2)
    made, axes = style.new_figure(
        0.5 * columns * style.PAGE, 0.2 + 1.9 * rows, nrows=rows, ncols=columns
    )
    for panel in axes.flat[max(len(numbers), 1) :]:
        panel.set_axis_off()
    if not numbers:
        style.say_instead(axes[0, 0], "no mode has a shape")
    coloured = None
    for panel, mode in zip(axes.flat, numbers, strict=False):
        coloured = draw_shape(panel, modes, mode)
        panel.set_title(
            title_of(modes, mode).partition(" 1/s at ")[0] + " 1/s", fontsize=8
        )
    _add_colour_bar(made, axes, coloured)
    return made


def _add_colour_bar(
    made: Figure, axes: np.ndarray, coloured: ScalarMappable | None
) -> None:
    """Add the scale of the colours beside all panels, where a mesh is drawn."""
    if coloured is not None:
        bar = made.colorbar(coloured, ax=axes.ravel().tolist(), shrink=0.8, pad=0.01)
        bar.set_label("amplitude over the largest")
