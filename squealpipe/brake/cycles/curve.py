"""Curves of special periodic motions of model A1 in two parameters or angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.cycles.cycle import IN_SYSTEM, cycle_from, n_events
from squealpipe.brake.models.refusals import refuse_unread
from squealpipe.brake.schema.cycles import a1_cycle_curve_schema
from squealpipe.parameters import NUMBERS_OF_A1, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.branch_labels import Label
from squealpipe.systems.cycles.curve import check, point_of
from squealpipe.systems.cycles.curve_following import ENDS, follow_curve
from squealpipe.validation import Angle, Number, Several


@recorded(
    model="A1", method="pseudo-arclength continuation of the legs and one condition"
)
def cycle_curve(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    label: str,
    parameters: Sequence[str],
    start: xr.Dataset,
    to: Mapping[str, tuple[Number, Number]] | None = None,
    n_points: Several = 200,
) -> xr.Dataset:
    """The curve of a special point of a branch, in two parameters or angles, in both directions.

    It goes on with a new order of events where motions beyond have one, or ends there.

    Args:
        params: those of the branch.
        alpha1, alpha2: angles of the branch, rad.
        label: ``fold``, ``period_doubling``, ``torus``, ``grazing`` or ``stick_onset``.
        parameters: names of two physical parameters, "alpha1" or "alpha2".
        start: a dataset of ``cycle_branch``, whose first point of that label is taken, or one
            point of it.
        to: parameter → (lowest, highest) value at which the curve ends.
        n_points: most points, of both directions together.

    Returns:
        Dataset ``cycle_curve`` over ``point``; ``label`` says what else happens there.

    Raises:
        ValueError: a label or parameter that does not exist, limits that do not ascend or leave the
            start out, or no such point in ``start``.
    """
    own = {"alpha1": alpha1, "alpha2": alpha2}
    point = point_of(start, label)
    followed = str(start.attrs["parameter"])
    limits = dict(to or {})
    # a cycle is also looked for next to the value: at the very onset of stick, round-off decides
    # how a run goes on
    parameter_steps = (0.0, -1e-12, 1e-12, -1e-9, 1e-9)
    for parameter_step in parameter_steps:
        at = {followed: float(point[followed]) * (1.0 + parameter_step)}
        if followed in own:
            own |= at
        else:
            params = params.with_(**at)
        design = Design(params, own["alpha1"], own["alpha2"])
        known = [
            *(
                name
                for name in NUMBERS_OF_A1.values()
                if getattr(params, name) is not None
            ),
            *own,
        ]
        check(known, label, parameters, limits)
        refuse_unread(params, parameters)
        cycle, _ = cycle_from(
            design, [float(point[f"{name}_start"]) for name in STATE], varied=parameters
        )
        if cycle is not None:
            break
    else:
        raise ValueError("no cycle is found from start")
    points, ends = follow_curve(
        cycle,
        Label[label],
        [IN_SYSTEM[name] for name in parameters],
        {IN_SYSTEM[name]: limit for name, limit in limits.items()},
        n_points,
    )
    values = {
        name: [point.cycle.parameters[IN_SYSTEM[name]] for point in points]
        for name in {*parameters, "alpha1", "alpha2"}
    }
    reasons = dict(
        zip(
            ENDS,
            (
                Outcome.point_limit,
                Outcome.converged,
                Outcome.branch_lost,
                Outcome.real_multipliers,
            ),
            strict=True,
        )
    )
    return build(
        a1_cycle_curve_schema,
        {
            **values,
            "period": [point.cycle.period * point.cycle.second for point in points],
            "residual": [point.residual for point in points],
            "label": [point.label for point in points],
            "events": [n_events(point.cycle) for point in points],
            "outcome": [reasons.get(end, Outcome.order_changes) for end in ends],
            "change": ["" if end in reasons else end for end in ends],
        },
        {"point": np.arange(len(points)), "parameter": list(parameters)},
        {"curve": label},
    )
