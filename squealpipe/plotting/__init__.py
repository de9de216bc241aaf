"""Pictures of datasets: one panel of any of them, and what a command draws."""

from collections.abc import Callable, Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.plotting.assess import draw_settled_orbit
from squealpipe.plotting.assess import figure as assess_figure
from squealpipe.plotting.axis_units import in_units
from squealpipe.plotting.contact_points import draw_onsets
from squealpipe.plotting.curves import draw_curves
from squealpipe.plotting.cycles import draw_backbone, draw_branch, draw_cycle
from squealpipe.plotting.mesh_scene import draw_forces
from squealpipe.plotting.mode_shapes import draw_shape, figure_of_mode, title_of
from squealpipe.plotting.modes import draw_modes
from squealpipe.plotting.modes import figure as modes_figure
from squealpipe.plotting.operating_map import draw_points
from squealpipe.plotting.operating_map import figure as operating_figure
from squealpipe.plotting.propensity import draw_shares, draw_verdicts
from squealpipe.plotting.propensity import figure as propensity_figure
from squealpipe.plotting.propensity import (
    figure_of_structure as structure_propensity_figure,
)
from squealpipe.plotting.quantities import draw_quantity, mark_changed, shown
from squealpipe.plotting.run import draw_force, draw_spectrum, draw_spectrum_in_hertz
from squealpipe.plotting.run import figure as run_figure
from squealpipe.plotting.squeal_ladder import draw_level
from squealpipe.plotting.squeal_ladder import figure as squeal_ladder_figure
from squealpipe.plotting.squealing import draw_poles
from squealpipe.plotting.squealing import figure as squealing_figure
from squealpipe.plotting.style import COLUMN, SETTINGS, new_figure
from squealpipe.plotting.systems import draw_ensemble, draw_path, draw_states
from squealpipe.schema import SYSTEM
from squealpipe.structures.schema.structures import NAME as COMPLEX_MODES
from squealpipe.validation import checked


@checked
def plot(
    dataset: xr.Dataset,
    ax: Axes | None = None,
    *,
    variable: str | None = None,
    mode: int | None = None,
) -> Axes:
    """Draw a dataset: a run, a map, a branch, a cycle, an ensemble; its schema says which.

    A picture that would be empty says why instead.

    Args:
        dataset: what a function of this package returned or :func:`squealpipe.load` read.
        ax: Matplotlib axes to draw on; by default those of a new figure.
        variable: draw this variable, over its one or two dimensions, instead of the usual picture.
        mode: of complex modes, draw the shape of the one with this number.

    Returns:
        The axes.

    Raises:
        ValueError: there is no picture of this kind of dataset, or it has too many dimensions.
    """
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    if ax is not None:
        _draw(ax, dataset, variable, mode)
        return ax
    # outside of the context, which would undo what a backend sets at its first figure
    figure = plt.figure(figsize=(5.0, 3.4), layout="constrained")
    with mpl.rc_context(SETTINGS):
        ax = figure.add_subplot()
        try:
            _draw(ax, dataset, variable, mode)
        except ValueError:
            plt.close(figure)
            raise
    return ax


def picture(
    dataset: xr.Dataset,
    variable: str | None = None,
    *,
    mode: int | None = None,
    units: Sequence[str] = (),
) -> Figure:
    """The picture that a command writes: that of :func:`plot`, or one of several panels.

    Args:
        units: of the axes that measure such things, as :func:`in_units` takes them.
    """
    if mode is not None:
        _check_modes(dataset)
        return figure_of_mode(dataset, mode)
    # these have a picture of several panels
    figure_by_schema = {
        "assess": assess_figure,
        "simulation": run_figure,
        "propensity": propensity_figure,
        "structure_propensity": structure_propensity_figure,
        "operating_map": operating_figure,
        "squealing_modes": squealing_figure,
        "squeal_ladder": squeal_ladder_figure,
        COMPLEX_MODES: modes_figure,
    }
    several = figure_by_schema.get(_schema(dataset))
    if several is not None and variable is None:
        figure = several(dataset)
    else:
        figure, axes = new_figure(COLUMN, 3.0)
        _draw(axes[0, 0], dataset, variable)
    in_units(figure, units, dataset)
    return figure


def _schema(dataset: xr.Dataset) -> str:
    """The schema by which the picture is chosen: that of modes or maps whatever they are over."""
    schema = str(dataset.attrs.get("schema", "the file"))
    name, over, _ = schema.partition(" over ")
    return name if over and name in (COMPLEX_MODES, "operating_map") else schema


def _check_modes(dataset: xr.Dataset) -> None:
    """Refuse a number of a mode where there are none."""
    if _schema(dataset) != COMPLEX_MODES:
        raise ValueError(
            f"mode (--mode): {_schema(dataset)} has no modes; give what complex_modes or "
            "`squealpipe modes` makes"
        )


def _draw(
    axes: Axes, dataset: xr.Dataset, variable: str | None, mode: int | None = None
) -> None:
    if mode is not None:
        _check_modes(dataset)
        draw_shape(axes, dataset, mode)
        axes.set_title(title_of(dataset, mode), fontsize=8)
        return
    schema = _schema(dataset)
    # all other schemas are drawn as squealpipe.plotting.quantities says
    draw_by_schema: dict[str, Callable[[Axes, xr.Dataset], None]] = {
        "assess": draw_settled_orbit,
        "simulation": draw_force,
        "run_summary": draw_spectrum,
        "spectrum": draw_spectrum_in_hertz,
        "backbone": draw_backbone,
        "limit_cycle": draw_cycle,
        "periodic_orbit": draw_cycle,
        "cycle_branch": draw_branch,
        "doubled_branch": draw_backbone,
        "contact_boundary": draw_curves,
        "cycle_curve": draw_curves,
        "regime_chart": draw_curves,
        "stability_boundaries": draw_curves,
        "propensity": draw_shares,
        "structure_propensity": draw_verdicts,
        "squealing_modes": draw_poles,
        "structure_run": draw_forces,
        "squeal_ladder": draw_level,
        "operating_map": draw_points,
        "contact_points": draw_onsets,
        COMPLEX_MODES: draw_modes,
        SYSTEM + "simulate": draw_states,
        SYSTEM + "ensemble": draw_ensemble,
        SYSTEM + "limit cycle": draw_path,
        SYSTEM + "cycle branch": draw_branch,
        SYSTEM + "cycle curve": draw_curves,
    }
    if variable is None and schema in draw_by_schema:
        draw_by_schema[schema](axes, dataset)
        return
    if variable is None and (quantity := shown(dataset)) is not None:
        draw_quantity(axes, quantity)
        if "motion_changed" in dataset and quantity.ndim == 2:
            mark_changed(axes, dataset)
        return
    if variable is None and "schema" not in dataset.attrs:
        variable = _first_drawable(dataset)
    if variable not in dataset:
        there = ", ".join(map(str, dataset.data_vars)) or "none"
        raise ValueError(
            f"{schema} has no picture of its own; name one of its variables with variable "
            f"(--variable): {there}"
            if variable is None
            else f"variable = {variable!r}: {schema} has {there}"
        )
    draw_quantity(axes, dataset[variable])


def _first_drawable(dataset: xr.Dataset) -> str | None:
    """Return the first numeric variable over one or two dimensions of another program's file."""
    return next(
        (
            str(name)
            for name, variable in dataset.data_vars.items()
            if variable.ndim in (1, 2) and variable.dtype.kind in "biuf"
        ),
        None,
    )
