"""Boundaries over two parameters as curves."""

from enum import IntEnum

from squealpipe.codes import LinearRegime
from squealpipe.parameters import TABLE
from squealpipe.schema import (
    DatasetSchema,
    Variable,
    count,
    flag,
    outcome,
    text,
    whether,
)
from squealpipe.systems.datasets.agreement import Listing
from squealpipe.systems.datasets.outcomes import Outcome


class PointKind(IntEnum):
    """Kind of a boundary's point."""

    arc = 0
    corner = 1
    border = 2


class ChartLine(IntEnum):
    """Change across a line of a regime chart."""

    flutter = 0
    divergence = 1
    contact_lost = 2
    whirl = 3
    stick = 4


varied_parameters = {
    "alpha1": Variable("angle of spring 1", "rad", ("point",), optional=True),
    "alpha2": Variable("angle of spring 2", "rad", ("point",), optional=True),
    **{
        name: Variable(what, "1", ("point",), optional=True)
        for name, what in {
            "kappa": "k3/k1",
            "lambda_": "L1/l_pre, both lengths in their proportion",
        }.items()
    },
    **{
        name: Variable(row.meaning, row.units, ("point",), optional=True)
        for name, row in TABLE.items()
        if row.enters_a1
        and row.allowed != "law"
        and name not in {"mass", "k1", "preload"}
    },
}
"""The two that vary are there."""

parameter_coordinate = {"parameter": text("parameter that varies", "parameter")}

contact_boundary_schema = DatasetSchema(
    name="contact_boundary",
    title="Where model A1, from rest, just keeps contact: arcs and corners over two parameters",
    coordinates={
        "point": count("point", "point"),
        **parameter_coordinate,
        "row": Variable("given values of the first parameter", dims=("row",)),
        "column": Variable("given values of the second parameter", dims=("column",)),
    },
    variables={
        **varied_parameters,
        "kept": whether(
            "whether contact is kept, by the side of the curves", "row", "column"
        ),
        "curve": count(
            "connected curve, contact kept on its left (of one that is closed, the first point "
            "comes again)",
            "point",
        ),
        "arc": count("arc: one maximum of y touches", "point"),
        "touch_time": Variable(
            "time at which contact is just lost", "s", ("point",), rtol=1e-6
        ),
        "residual": Variable(
            "distance of that maximum of y from l_pre, over l_pre",
            dims=("point",),
            rtol=1.0,
            atol=1e-8,
        ),
        "corner": whether("whether two maxima touch at once", "point"),
        "kind": flag("what the point is", PointKind, "point"),
        "region_kept": whether("whether contact is kept there", "region"),
        "region_area": Variable(
            "area, in the units of both parameters", "1", ("region",), rtol=1e-5
        ),
        "region_area_error": Variable(
            "error of the area, from the shape of the arcs", "1", ("region",), rtol=1.0
        ),
        "kept_share": Variable("share of the rectangle in which contact is kept"),
        "kept_share_error": Variable("error of that share", rtol=1.0),
        "outline": Variable(
            "closed lines around the regions in which contact is kept, and around their holes: "
            "values of both parameters",
            dims=("vertex", "parameter"),
        ),
        "outline_loop": count("line that a vertex belongs to", "vertex"),
        "range": Variable("lowest and highest value", dims=("parameter", "end")),
        "t_end": Variable("end of each run", "s"),
        "runs": count("runs", dtype="i8", volatile=True),
        "smallest_island": Variable(
            "area of a disc that the map cannot miss: a region that no other curve leads to is "
            "found for sure from this size on"
        ),
        "outcome": outcome(among=(Outcome.converged, Outcome.unresolved)),
    },
)

boundary_distance_schema = DatasetSchema(
    name="boundary_distance",
    title="How far a design is from the boundary of kept contact",
    coordinates=parameter_coordinate,
    variables={
        "design": Variable("value of the design", dims=("parameter",)),
        "kept": whether("whether contact is kept there"),
        "distance": Variable(
            "distance of the nearest point, in the units of both parameters"
        ),
        "nearest": Variable("nearest point of the boundary", dims=("parameter",)),
        "outcome": outcome(among=(Outcome.converged, Outcome.not_computed)),
    },
)

regime_chart_schema = DatasetSchema(
    name="regime_chart",
    title="Lines over two parameters across which A3 is unstable or A1, from rest, loses contact",
    lists={
        "point": Listing(
            kinds=("line", "curve"),
            position="parameter",
            fillers=(int(ChartLine.whirl), int(ChartLine.stick)),
        )
    },
    coordinates={
        "point": count("point", "point"),
        **parameter_coordinate,
        "boundary": text("what changes", "boundary"),
    },
    variables={
        **varied_parameters,
        "line": flag("what changes across the line", ChartLine, "point"),
        "curve": count("connected line", "point"),
        "residual": Variable(
            "of the function that is zero on the line",
            dims=("point",),
            rtol=1.0,
            atol=1e-8,
        ),
        "cell_regime": flag(
            "what A3 does in cells of equal size", LinearRegime, "row", "column"
        ),
        "cell_kept": whether("whether contact is kept", "row", "column"),
        "region_regime": flag("what A3 does there", LinearRegime, "region"),
        "region_kept": whether("whether contact is kept there", "region"),
        "region_place": Variable("a place well inside", dims=("region", "parameter")),
        "region_share": Variable("share of the chart", dims=("region",)),
        "design": Variable(
            "values of designs", dims=("place", "parameter"), optional=True
        ),
        "distance": Variable(
            "distance of the nearest point, in the units of both parameters; infinite: none",
            dims=("place", "boundary"),
            optional=True,
            rtol=1e-5,
        ),
        "range": Variable("lowest and highest value", dims=("parameter", "end")),
        "t_end": Variable("end of each run", "s"),
        "runs": count("runs", dtype="i8", volatile=True),
        "outcome": outcome("boundary", among=(Outcome.converged, Outcome.unresolved)),
    },
)
