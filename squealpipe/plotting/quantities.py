"""One variable over one or two dimensions: curves, maps, and maps of kinds."""

from collections.abc import Mapping
from textwrap import fill

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from squealpipe.codes import flag_words
from squealpipe.parameters import TABLE
from squealpipe.plotting import style
from squealpipe.schema import SYSTEM, meanings


def shown(dataset: xr.Dataset) -> xr.DataArray | None:
    """The variable that the picture of a dataset, or of a sweep of such datasets, shows."""
    schema = (
        str(dataset.attrs.get("schema")).removeprefix("sweep of ").split(" over ")[0]
    )
    schema = "basin_map" if schema.startswith("basin_map") else schema
    # Schema → the variable that its picture shows, and what is chosen of its further dimensions;
    # of what is left beyond two, the first
    shown_variables: dict[str, tuple[str, Mapping[str, object]]] = {
        "validity_map": ("first_separation_time", {}),
        "refined_validity_map": ("separates", {}),
        "hammering_map": ("motion", {}),
        "quasi_static_map": ("reaction_force", {}),
        "stability_map": ("regime_linear", {}),
        "critical_friction_map": ("critical_mu", {}),
        "critical_damping_map": ("critical_mu", {}),
        "natural_frequencies": ("omega", {"mode": 1, "contact_state": "contact"}),
        "basin_map": ("motion", {}),
        "smallest_disturbance": ("distance_by_number", {}),
        SYSTEM + "basin": ("motion", {}),
        "a1_beside_a4": ("omega_a1", {}),
        "assumptions": ("held", {}),
        "benchmark": ("verdict", {}),
        "boundary_distance": ("nearest", {}),
        "claims": ("verdict", {}),
        "explorer": ("outcome", {}),
        "failure_atlas": ("verdict", {}),
        "fewer_points": ("growth_rate", {}),
        "harmonic_forms": ("omega", {}),
        "linear_pull": ("lowest_contact_force", {}),
        "model_ladder": ("cheapest", {"question": "contact_lost"}),
        "own_scenes": ("separated_fraction", {}),
        "parameter_inference": ("share", {}),
        "settled_extremes": ("late_max_x", {}),
        "transient": ("lifetime", {}),
        "verdict_robustness": ("share", {}),
        "whirl": ("amplitude", {}),
        "work_precision": ("error", {}),
    }
    if schema not in shown_variables:
        return None
    name, chosen = shown_variables[schema]
    variable = dataset[name].sel(chosen)
    return variable.isel(dict.fromkeys(variable.dims[2:], 0))


def counts(dataset: xr.Dataset) -> list[str]:
    """Describe the values of the drawn variable in one line of text."""
    variable = shown(dataset)
    assert variable is not None, dataset.attrs  # noqa: S101 (maps of the command line are in shown_variables)
    if table := meanings(variable):
        codes, numbers = np.unique(variable.values, return_counts=True)
        rows = [
            (n, flag_words(table[code])) for code, n in zip(codes, numbers, strict=True)
        ]
        if "motion_changed" in dataset:
            rows.append(
                (int(dataset.motion_changed.sum()), "another kind in the last quarter")
            )
        return [f"{number} of {variable.size} cells: {words}" for number, words in rows]
    values = variable.values
    finite = np.isfinite(values)
    return [
        f"{label(variable)}: in {np.count_nonzero(finite)} of {values.size} cells, "
        f"from {values[finite].min():.6g} to {values[finite].max():.6g}"
        if finite.any()
        else f"{_words(variable)}: in no cell"
    ]


def mark_changed(axes: Axes, dataset: xr.Dataset) -> None:
    """Dots where the label of a motion still changes within the second half of its run."""
    changed = dataset.motion_changed
    x, y = (changed[dim].values for dim in changed.dims)
    first, second = np.nonzero(changed.values)
    axes.plot(x[first], y[second], ".", color=style.Colour.black, ms=1.2)


def draw_quantity(axes: Axes, variable: xr.DataArray) -> None:
    """A curve over one dimension or a map over two, the first one along x."""
    if variable.ndim not in (1, 2) or variable.dtype.kind not in "biuf":
        raise ValueError(
            f"{variable.name} has dimensions {tuple(variable.dims)} and dtype {variable.dtype}; "
            "one or two dimensions of numbers can be drawn: choose with dataset.sel or isel"
        )
    x = variable[variable.dims[0]]
    table = meanings(variable) or (
        {0: "no", 1: "yes"} if variable.dtype.kind == "b" else {}
    )
    values, names = variable.values.astype(float), []
    if table:
        present, places = np.unique(variable.values, return_inverse=True)
        names = [table[int(code)] for code in present]
        values = places.reshape(variable.shape).astype(float)
    if not np.isfinite(values).any():
        style.say_instead(axes, f"{_words(variable)}:\nno value anywhere")
        return
    chosen = [
        style.angle_in_words(str(name), at.item())
        if name in style.ANGLE_NAMES
        else f"{name} {at.item()}"
        for name, at in variable.coords.items()
        if not at.ndim
    ]
    axes.set_title(", ".join(chosen), loc="left")
    axes.set_xlabel(label(x))
    by_name = x.dtype.kind in "OUT"
    if by_name:
        axes.tick_params("x", rotation=90)
    if variable.ndim == 1:
        axes.plot(
            x.values, values, "." if names or by_name else "-", color=style.Colour.blue
        )
        axes.set_ylabel(label(variable))
        if names:
            axes.set_yticks(range(len(names)), list(map(flag_words, names)))
        return
    _draw_map(axes, variable, values, names)


def _draw_map(
    axes: Axes, variable: xr.DataArray, values: np.ndarray, names: list[str]
) -> None:
    x, y = (variable[dim] for dim in variable.dims)
    if names:
        free = iter(
            style.Colour.palette * len(names)
        )  # for flags without a colour of their own
        colours = [style.REGIME_COLOURS.get(name) or next(free) for name in names]
        scale = style.category_colours(colours)
    else:
        low, high = np.percentile(values[np.isfinite(values)], [1, 99])
        scale = {"cmap": "viridis", "vmin": low, "vmax": high}
    if variable.dims == style.ANGLE_NAMES:
        mesh = style.draw_map(axes, variable, values, **scale)
    else:
        places = [
            np.arange(each.size) if each.dtype.kind in "OUT" else each.values
            for each in (x, y)
        ]
        mesh = axes.pcolormesh(
            *places, values.T, shading="nearest", rasterized=True, **scale
        )
        for axis, each, place in zip(
            (axes.xaxis, axes.yaxis), (x, y), places, strict=True
        ):
            if each.dtype.kind in "OUT":
                axis.set_ticks(place, list(map(str, each.values)))
        axes.set_ylabel(label(y))
    figure = axes.get_figure(root=False)
    assert figure is not None  # noqa: S101 (axes that can be drawn on are in a figure)
    if not names:
        extend = {"label": label(variable), "extend": "both"}
        figure.colorbar(mesh, ax=axes, shrink=0.85, **extend)  # type: ignore[arg-type]
        return
    axes.set_title(fill(_words(variable), 32), loc="left")
    bar = figure.colorbar(mesh, ax=axes, ticks=range(len(names)), shrink=0.85)
    bar.ax.set_yticklabels([flag_words(name).replace(" ", "\n", 1) for name in names])


def _words(variable: xr.DataArray) -> str:
    return (
        str(variable.attrs.get("long_name", variable.name))
        .split(" (")[0]
        .split("; ")[0]
    )


def label(variable: xr.DataArray) -> str:
    """Return a variable's long name with its unit, as an axis label."""
    # units of the CF convention as axes write them
    written = {"s-1": "1/s", "rad s-1": "rad/s", "m s-1": "m/s"}
    unit = written.get(unit := str(variable.attrs.get("units", "1")), unit)
    name = str(variable.name)
    words = _words(variable)
    if name in style.ANGLE_NAMES or (words == name and name in TABLE):
        words = style.symbol(name)
    return words if unit == "1" else f"{words} ({unit})"
