"""Schema of ``contact_points``: an elastic pad on one, two and more contact points.

Total stiffness and preload are the same in all; a stiff pad stands beside them. Each design has
its onset and unstable modes, the motion that pushed steady sliding ends in, and what each contact
point does in that motion.
"""

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

MOST_FRICTION = 1.0
"""The largest friction at which an onset is looked for."""


def _of_point(long_name: str, units: str = "1") -> Variable:
    return or_nan(
        f"{long_name}; NaN where there is no such point",
        units,
        ("design", "point"),
        atol=0.02,
    )


contact_points_schema = DatasetSchema(
    name="contact_points",
    title="An elastic pad on one, two and more contact points, and a stiff one",
    coordinates={
        "design": text("the pad's contact points, and whether it is stiff", "design"),
        "point": count("contact point, from the leading edge", "point"),
        "instant": Variable("time in periods of the strongest line", dims=("instant",)),
    },
    variables={
        "contacts": count("contact points", "design"),
        "young": Variable("modulus of elasticity", "Pa", ("design",)),
        "n_modes": count("modes in which it was run", "design"),
        "frequency_error": Variable(
            "largest relative error of an unstable frequency, from the reduction",
            dims=("design",),
            atol=1e-6,
        ),
        "growth_rate_error": Variable(
            "largest error of an unstable growth rate, over the larger of it and 1 % of ω",
            dims=("design",),
            atol=1e-6,
        ),
        "critical_mu": or_nan(
            "smallest friction at which a mode turns unstable; NaN: none up to "
            f"{MOST_FRICTION:g}",
            "1",
            ("design",),
            rtol=1e-6,
        ),
        "unstable": count("unstable modes", "design"),
        "frequency": or_nan(
            "frequency of the fastest of them", "Hz", ("design",), rtol=1e-6
        ),
        "growth_rate": or_nan("its growth rate", "s-1", ("design",), rtol=1e-5),
        "verdict": flag(
            "what steady sliding ends in after a push of 1 % along its least stable mode",
            Verdict,
            "design",
        ),
        "dominant_frequency": or_nan(
            "strongest line of that motion", "Hz", ("design",), rtol=0.01
        ),
        "velocity_rms": or_nan(
            "its rms speed at the contacts", "m s-1", ("design",), rtol=0.05
        ),
        "share": or_nan(
            "share of the random starts that end in it", "1", ("design",), atol=0.5
        ),
        "common_frequency": or_nan(
            "strongest line of what most random starts end in",
            "Hz",
            ("design",),
            volatile=True,
        ),
        "position": _of_point("place over the pad's length"),
        "separated_fraction": _of_point("share of the time without contact"),
        "stick_fraction": _of_point("share of the time in stick"),
        "peak_force": or_nan(
            "largest force over its preload", "1", ("design", "point"), rtol=0.1
        ),
        "lag": or_nan(
            "delay of the force behind that of the first point, at the strongest line, in periods",
            "1",
            ("design", "point"),
            volatile=True,
        ),
        "force": or_nan(
            "normal force over its preload",
            "1",
            ("design", "point", "instant"),
            volatile=True,
        ),
        "outcome": outcome("design", among=(Outcome.converged, Outcome.unresolved)),
    },
)
