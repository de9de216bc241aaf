"""Exact boundary curves of the linear maps."""

import numpy as np
import xarray as xr

from squealpipe.brake.models import a3
from squealpipe.brake.models.refusals import refuse_extensions
from squealpipe.brake.schema.linear import BoundaryCurve, stability_boundaries_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import build


def stability_boundaries(params: Parameters, *, points: int = 400) -> xr.Dataset:
    """Curves over the angle map where a linear regime or the sign of A2's reaction changes.

    All of them are circles or lines in the plane of Z (see :mod:`squealpipe.brake.models.a3`), from
    where the angles follow in closed form, so each point is exact to round-off.

    Returns:
        Dataset over point: alpha1, alpha2 (rad, continuous along a segment, hence not confined
        to 0 … π; the map has period π in either angle), boundary, segment.
    """
    reason = "its curves are circles of the undamped model A3 alone"
    refuse_extensions(params, "stability_boundaries", reason)
    total = params.k1 + params.k2
    arcs = {
        BoundaryCurve.flutter: a3.circle_arcs(
            params, *a3.flutter_circle(params, params.k3), points
        ),
        BoundaryCurve.divergence: a3.circle_arcs(
            params, *a3.divergence_circle(params, params.k3), points
        ),
        BoundaryCurve.reaction_changes_sign: a3.line_parts(
            params, 1 - 1j * params.drag, -total, points
        ),
        BoundaryCurve.no_coupling: a3.line_parts(params, 1j, 0.0, points),
    }
    segments = [
        (boundary, *np.unwrap(branch, period=np.pi))
        for boundary, parts in arcs.items()
        for z in parts
        for branch in np.stack(a3.angles_from_plane(z, params), axis=1)
    ]
    if params.k1 == params.k2:
        # Z = 0 all along α1 + α2 = π/2 and 3π/2, where angles_from_plane has no answer.
        along = np.linspace(0.0, np.pi, points)
        segments += [
            (BoundaryCurve.no_coupling, along, turn - along)
            for turn in (np.pi / 2, 1.5 * np.pi)
        ]
    alpha1, alpha2 = (
        np.concatenate([segment[i] for segment in segments]) for i in (1, 2)
    )
    return build(
        stability_boundaries_schema,
        {
            "alpha1": alpha1,
            "alpha2": alpha2,
            "boundary": np.repeat([segment[0] for segment in segments], points),
            "segment": np.repeat(np.arange(len(segments)), points),
        },
        {"point": np.arange(alpha1.size)},
    )
