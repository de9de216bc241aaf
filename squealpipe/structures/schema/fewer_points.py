"""Unstable modes of a structure with one, two, four and more contacts for each face of a mesh."""

from squealpipe.schema import DatasetSchema, Outcome, count, or_nan, outcome

fewer_points_schema = DatasetSchema(
    name="fewer_points",
    title="Unstable modes of a structure by the number of contact points of each face",
    coordinates={"points": count("contact points of each face, at most", "points")},
    variables={
        "contacts": count("contacts of the structure", "points"),
        "unstable_modes": count("modes of steady sliding that grow", "points"),
        "growth_rate": or_nan(
            "largest growth rate; NaN: no mode grows", "s-1", ("points",), rtol=1e-5
        ),
        "frequency": or_nan("frequency of this mode", "Hz", ("points",), rtol=1e-6),
        "outcome": outcome(
            "points",
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_sliding_state),
        ),
    },
)
