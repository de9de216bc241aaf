"""The dataset behind the explorer page: motions, spectra and backbones on a grid of angles."""

from dataclasses import replace
from typing import Any

from squealpipe.brake.schema.backbones import backbone_schema
from squealpipe.brake.schema.dynamics.runs import (
    angular_frequency_coordinate,
    simulation_schema,
    time_coordinate,
)
from squealpipe.brake.schema.linear import MAP, angle_coordinates, mode_coordinate
from squealpipe.schema import RUN_ENDS, DatasetSchema, Variable, count, outcome

SINGLE_PRECISION: dict[str, Any] = {"dtype": "f4", "rtol": 1e-5, "atol": 1e-6}
"""Single precision: what is drawn, not computed with."""
HISTORIES = ("x", "y", "normalized_contact_force")
ORBITS = ("omega", "x_amplitude", "y_amplitude", "y_peak", "stability_index")

explorer_schema = DatasetSchema(
    name="explorer",
    title="Motions from rest (A1), their spectra, and exact backbones (A4) over both angles",
    coordinates={
        **angle_coordinates,
        **{
            name: replace(entry, optional=True)
            for name, entry in mode_coordinate.items()
        },
        "time": time_coordinate,
        "frequency": angular_frequency_coordinate,
        "point": count("point along the branch", "point", optional=True),
    },
    variables={
        **{
            name: replace(
                simulation_schema.variables[name],
                dims=(*MAP, "time"),
                nan_allowed=False,
                round_off=None,
                **SINGLE_PRECISION,
            )
            for name in HISTORIES
        },
        "force_spectrum": Variable(
            "amplitude spectrum of the normalized contact force",
            dims=(*MAP, "frequency"),
            dtype="f4",
            rtol=1e-4,
            atol=1e-5,
        ),
        "outcome": outcome(*MAP, among=RUN_ENDS),
        **{
            name: replace(
                backbone_schema.variables[name],
                dims=(*MAP, "mode", "point"),
                nan_allowed=True,
                optional=True,
                **SINGLE_PRECISION,
            )
            for name in ORBITS
        },
        "end": replace(
            backbone_schema.variables["end"], dims=(*MAP, "mode"), optional=True
        ),
        "preload": Variable("precompression l_pre of the contact spring", "m"),
        "length1": Variable("free length of spring 1", "m"),
        "length2": Variable("free length of spring 2", "m"),
        "belt_speed": Variable("belt speed V", "m s-1"),
    },
)
