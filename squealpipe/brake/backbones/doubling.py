"""The branch of doubled period that leaves a backbone of model A4 at a period doubling."""

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.brake.a4.doubled_branches import OFFSETS, doubled_branch_from
from squealpipe.brake.a4.exact_branches import exact_branch
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.backbones.backbone import (
    exact_variables,
    special_beyond_contact,
    special_variables,
)
from squealpipe.brake.backbones.orbit import check_length
from squealpipe.brake.models.a4 import first_integral_value
from squealpipe.brake.orbits.orbits import Orbit
from squealpipe.brake.orbits.special_points import special_points
from squealpipe.brake.schema.backbones import doubled_branch_schema
from squealpipe.codes import SpecialPoint
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.validation import Angle, Mode, Natural, Positive, checked


@checked
def doubled_branch(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    mode: Mode,
    doubling: Natural = 1,
    y_peak_max: Positive | None = None,
) -> xr.Dataset:
    """The family of motions of doubled period that leaves a backbone at a period doubling.

    The backbone is followed to the doubling (stability index −2), which is located to
    round-off; there the conditions of rest over two periods lose rank at one of the two instants
    of rest, and the null direction leads to the new orbits. They are symmetric and exact like
    those of ``backbone``, and are followed in the same steps.

    Args:
        doubling: which period doubling along the backbone, from 1.
        y_peak_max: larger y of the instants of rest, m, to which both branches are followed;
            6 l_pre by default. The new orbits pass the other instant of rest of the old ones
            in motion, so it is not always the largest y of a period (``y_largest``).

    Returns:
        Dataset over ``point`` as from ``backbone``, the doubling first (run through twice, index
        2). ``end`` is ``no_doubling``, or the end of an empty backbone, where there is no branch.
    """
    y_max = 6.0 * params.preload if y_peak_max is None else y_peak_max
    check_length("y_peak_max", y_max, params.preload)
    scene = scaled_system(params, alpha1, alpha2)
    peak = y_max / scene.length
    simple, outcomes, end = exact_branch(scene, mode, peak, peak)
    special = special_beyond_contact(scene, simple, outcomes)
    doublings = [
        orbit for kind, orbit in special if kind is SpecialPoint.period_doubling
    ]
    attrs = {"alpha1": alpha1, "alpha2": alpha2, "mode": mode, "doubling": doubling}
    if len(doublings) < doubling:
        return _dataset(
            scene, params, [], None, Outcome.no_doubling if simple else end, attrs
        )
    start = doublings[doubling - 1]
    orbits, why = doubled_branch_from(scene, start, peak)
    return _dataset(scene, params, orbits, start, Outcome[why.name], attrs)


def _dataset(
    scene: ScaledSystem,
    params: Parameters,
    orbits: list[Orbit],
    start: Orbit | None,
    end: Outcome,
    attrs: dict[str, Any],
) -> xr.Dataset:
    special = special_points(scene.system, orbits[len(OFFSETS) :])
    variables = exact_variables(
        scene, params, orbits, [Outcome.converged] * len(orbits), end
    )
    stiffness = linear_stiffness(params, geometry(attrs["alpha1"], attrs["alpha2"]))
    rest = np.array([orbit.point[:2] for orbit in orbits]).reshape(-1, 2) * scene.length
    highest = [orbit.largest_y(scene.system) for orbit in orbits]
    return build(
        doubled_branch_schema,
        {
            **variables,
            **special_variables(scene, special),
            "y_largest": np.array(highest) * scene.length,
            "first_integral": first_integral_value(
                rest[:, 0], rest[:, 1], 0.0, 0.0, params, stiffness
            ),
            "doubling_omega": start.omega * scene.frequency if start else np.nan,
        },
        {"point": np.arange(len(orbits)), "special": np.arange(len(special))},
        attrs,
    )
