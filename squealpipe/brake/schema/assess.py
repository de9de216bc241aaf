"""Schemas of verdicts over the angles (``verdict_map``) and over a sample (``verdict_shares``).

``CURES`` and ``KICKS`` state which quantities of a pad are changed to stop the noise, and by which
strikes other motions are sought.
"""

from squealpipe.brake.schema.linear import MAP, angle_coordinates, angles_of_one_pair
from squealpipe.codes import Verdict
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
)
from squealpipe.vibration.schema import Mechanism

KICKS = ((0.0, 1.0), (-1.0, -0.5), (1.0, 2.0))
"""Velocities (along, across the belt) of three strikes by which other motions are sought, in units
of l_pre √((k1 + k2)/2m)."""


CURES = {
    "mu": "1",
    "k3": "N m-1",
    "k1": "N m-1",
    "k2": "N m-1",
    "alpha1": "rad",
    "alpha2": "rad",
    "damping": "1",
    "preload": "m",
    "belt_speed": "m s-1",
}
"""Quantities that are changed one at a time to stop the noise, with their units."""
verdict_map_schema = DatasetSchema(
    name="verdict_map",
    title="Whether a brake squeals or hammers, over both spring angles",
    coordinates=angle_coordinates,
    variables={
        "verdict": flag(
            "verdict on the motion that steady sliding settles on after a push",
            Verdict,
            *MAP,
        ),
        "mechanism": flag("why steady sliding is unstable", Mechanism, *MAP),
        "sliding_growth_rate": or_nan(
            "growth rate of small motions of A1 about its steady sliding", "s-1", MAP
        ),
        "outcome": outcome(
            *MAP,
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state),
        ),
    },
)

verdict_shares_schema = DatasetSchema(
    name="verdict_shares",
    title="Shares of the verdicts over scattered parameters",
    coordinates={"kind": text("verdict", "kind")},
    variables={
        "share": Variable("share of the sample", dims=("kind",), rtol=2e-2, atol=1e-2),
        **{
            f"share_{end}": Variable(
                f"{end} end of its 95 % interval", dims=("kind",), rtol=5e-2
            )
            for end in ("low", "high")
        },
        "samples": count("brakes in the sample", dtype="i8"),
        **angles_of_one_pair,
    },
)
