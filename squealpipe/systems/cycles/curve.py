"""Curves of special cycles in two parameters: folds, period doublings, tori, grazings, stick.

:mod:`squealpipe.systems.cycles.curve_equations` has their equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.systems.branch_labels import Label, Meeting
from squealpipe.systems.cycles.branch import started
from squealpipe.systems.cycles.curve_equations import RETURNS
from squealpipe.systems.cycles.curve_following import ENDS, CurvePoint, follow_curve
from squealpipe.systems.datasets import flag_table
from squealpipe.systems.inputs.gate import Number, Several, checked
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.labels import build, flag

if TYPE_CHECKING:
    from squealpipe.systems.tracing import TracedSystem as System


def check(
    known: Iterable[str],
    label: str,
    parameters: Sequence[str],
    to: Mapping[str, Sequence[float]],
) -> None:
    """Raise if the requested curve does not exist."""
    names = [each.name for each in (*RETURNS, Label.grazing, Label.stick_onset)]
    if label not in names:
        raise ValueError(f"label {label!r}: {suggestion(str(label), names)}")
    if len(set(parameters)) != 2 or len(parameters) != 2:
        raise ValueError(f"parameters = {parameters!r}: two names are needed")
    for name in parameters:
        if name not in known:
            raise ValueError(
                f"parameter {name!r} is unknown; {suggestion(name, known)}"
            )
    for name, limits in to.items():
        if name not in parameters:
            raise ValueError(f"to: {name!r} is unknown; {suggestion(name, parameters)}")
        if limits[0] >= limits[1]:
            raise ValueError(
                f"to: {name} = {limits!r}: two numbers that ascend are needed"
            )


def point_of(start: xr.Dataset, label: str) -> xr.Dataset:
    """The first point of a branch with a label, or the one that is given."""
    if "label" not in start:
        raise ValueError(
            "start: a branch of cycle_branch or one of its points is needed"
        )
    at = np.flatnonzero(np.atleast_1d(start["label"].values) == Label[label])
    if not len(at):
        raise ValueError(f"start has no point of {label}")
    return start.isel(point=int(at[0])) if "point" in start.dims else start


@checked
def cycle_curve(
    system: Any,
    label: str,
    parameters: Sequence[str],
    *,
    start: xr.Dataset,
    to: Mapping[str, tuple[Number, Number]] | None = None,
    n_points: Several = 200,
) -> xr.Dataset:
    """The curve of a special point of a branch, in two parameters, in both directions.

    Args:
        label: ``fold``, ``period_doubling``, ``torus``, ``grazing`` or ``stick_onset``.
        parameters: names of the two that vary.
        start: a branch, whose first point of that label is taken, or one point of it.
        to: parameter → (lowest, highest) value at which the curve ends.
        n_points: most points, of both directions together.

    Returns:
        Dataset over ``point``: both parameters by name, ``period``, ``residual`` and ``label``
        (what else happens there), ``events`` (their number); and over ``side`` (first, last)
        ``outcome``, why the curve ended: ``order_changes_…`` names what changes their order where
        it does not go on with the new one.

    Raises:
        ValueError: an unknown label or parameter, limits that do not ascend or leave the start out,
            or no such point in ``start``.
    """
    limits = dict(to or {})
    check(system.parameters, label, parameters, limits)
    cycle = started(system, point_of(start, label))
    points, ends = follow_curve(cycle, Label[label], parameters, limits, n_points)
    return _dataset(system, label, points, parameters, ends)


def _dataset(
    system: System,
    label: str,
    points: list[CurvePoint],
    parameters: Sequence[str],
    ends: list[str],
) -> xr.Dataset:
    cycles = [point.cycle for point in points]
    names = [*ENDS, *sorted(set(ends) - set(ENDS))]
    return build(
        system,
        "cycle curve",
        {
            "<parameter>": {
                name: [cycle.parameters[name] for cycle in cycles]
                for name in parameters
            },
            "period": [cycle.period * cycle.second for cycle in cycles],
            "events": [len(cycle.events) for cycle in cycles],
            "residual": [point.residual for point in points],
            "label": flag([point.label for point in points], flag_table(Meeting)),
            "outcome": flag([names.index(end) for end in ends], dict(enumerate(names))),
        },
        {},
        cycles[0].parameters,
        1e-14,
        curve=label,
        parameters_followed=" ".join(parameters),
    )
