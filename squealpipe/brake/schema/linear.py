"""Datasets of the linear models A2, A3 and of the natural frequencies."""

from dataclasses import replace
from enum import IntEnum

from squealpipe.codes import LinearRegime
from squealpipe.schema import (
    LINEAR_ENDS,
    DatasetSchema,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
    whether,
)
from squealpipe.systems.datasets.agreement import Listing

MAP = ("alpha1", "alpha2")

angle_coordinates = {
    "alpha1": Variable("angle of spring 1", "rad", ("alpha1",)),
    "alpha2": Variable("angle of spring 2", "rad", ("alpha2",)),
}
angles_of_one_pair = {
    name: replace(entry, dims=()) for name, entry in angle_coordinates.items()
}
"""The angles of a dataset that is of one pair."""
mode_coordinate = {"mode": count("mode, by ascending frequency", "mode")}


linear_regime_of_map = flag("stability regime of model A3", LinearRegime, *MAP)

stability_map_schema = DatasetSchema(
    name="stability_map",
    title="Linear stability (model A3) over both spring angles",
    coordinates={**angle_coordinates, **mode_coordinate},
    variables={
        "growth_rate": or_nan("largest real part of the eigenvalues", "s-1", MAP),
        "frequency": or_nan(
            "imaginary part of the eigenvalues", "rad s-1", (*MAP, "mode")
        ),
        "regime_linear": linear_regime_of_map,
        "shape_similarity": or_nan(
            "modal assurance criterion of both modes: 1 where they have one shape",
            dims=MAP,
            optional=True,
        ),
        "outcome": outcome(*MAP, among=LINEAR_ENDS),
    },
)


def _critical(suffix: str) -> Variable:
    return Variable(f"critical friction{suffix}", "1", MAP)


critical_friction_map_schema = DatasetSchema(
    name="critical_friction_map",
    title="Friction at which steady sliding loses its stability (model A3) over both spring angles",
    coordinates=angle_coordinates,
    variables={
        "critical_mu": _critical(""),
        "critical_mu_undamped": _critical(" without dashpots"),
        "critical_mu_vanishing": _critical(" as both dashpots vanish at their ratio"),
        "destabilized": whether("dashpots lower the critical friction", *MAP),
    },
)

critical_damping_map_schema = DatasetSchema(
    name="critical_damping_map",
    title="Friction at which steady sliding loses its stability (model A3) over both dashpots",
    coordinates={
        f"damping{i}": Variable(
            f"dashpot along spring {i}", "N s m-1", (f"damping{i}",)
        )
        for i in (1, 2)
    },
    variables={
        "critical_mu": Variable("critical friction", dims=("damping1", "damping2")),
        "critical_mu_undamped": Variable("critical friction without dashpots"),
        "destabilized": whether(
            "dashpots lower the critical friction", "damping1", "damping2"
        ),
        **angles_of_one_pair,
    },
)


def _stiffness(symbol: str) -> Variable:
    return Variable(f"{symbol} of Eq. (8), springs alone", "N m-1", MAP, optional=True)


quasi_static_map_schema = DatasetSchema(
    name="quasi_static_map",
    title="Quasi-static sliding (model A2) and the linear static state over both spring angles",
    coordinates=angle_coordinates,
    variables={
        "possible_as_printed": whether("Eq. (11) as printed holds", *MAP),
        "possible": whether("reaction force of model A2 is positive", *MAP),
        "reaction_force": or_nan("reaction force of model A2, y = 0", "N", MAP),
        "x_static": or_nan("x of the static state of Eq. (15)", "m", MAP),
        "y_static": or_nan("y of the static state of Eq. (15)", "m", MAP),
        "contact_force_static": or_nan(
            "contact force of the static state of Eq. (15), negative where k3 pulls",
            "N",
            MAP,
        ),
        "stiffness_x": _stiffness("K11"),
        "stiffness_xy": _stiffness("K12"),
        "stiffness_y": _stiffness("K22"),
        "outcome": outcome(*MAP, among=LINEAR_ENDS),
    },
)

natural_frequencies_schema = DatasetSchema(
    name="natural_frequencies",
    title="Natural frequencies of model A4, in contact and separated",
    coordinates={
        **angle_coordinates,
        **mode_coordinate,
        "contact_state": text("state of the contact", "contact_state"),
    },
    variables={
        "omega": Variable(
            "natural frequency", "rad s-1", (*MAP, "mode", "contact_state")
        ),
        "outcome": outcome(*MAP, "mode", "contact_state", among=LINEAR_ENDS),
    },
)


class BoundaryCurve(IntEnum):
    """Curve that a boundary point belongs to."""

    flutter = 0
    divergence = 1
    reaction_changes_sign = 2
    no_coupling = 3


stability_boundaries_schema = DatasetSchema(
    name="stability_boundaries",
    title="Exact boundaries of flutter, divergence and quasi-static sliding",
    lists={"point": Listing(kinds=("boundary", "segment"))},
    coordinates={"point": count("number of the point", "point")},
    variables={
        **{
            f"alpha{i}": Variable(
                f"angle of spring {i}, continuous along a segment",
                "rad",
                ("point",),
                atol=3e-8,  # at its turning points an arc cosine keeps half of the digits
            )
            for i in (1, 2)
        },
        "boundary": flag("which boundary", BoundaryCurve, "point"),
        "segment": count("points of one number are joined by a line", "point"),
    },
)
