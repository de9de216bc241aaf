"""The settled motion of a structure over time, for films and sounds."""

from squealpipe.codes import Regime
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
from squealpipe.schema.meshes import mesh_coordinates, mesh_entries

structure_run_schema = DatasetSchema(
    name="structure_run",
    title="Settled motion of a structure over time",
    coordinates={
        "time": Variable("time", "s", ("time",)),
        "contact": text("name of the contact", "contact"),
        **mesh_coordinates,
    },
    variables={
        "displacement": Variable(
            "coordinates of the structure as it was run, from rest without load",
            "m",
            ("time", "coordinate"),
            volatile=True,
        ),
        "velocity": Variable(
            "their velocities", "m s-1", ("time", "coordinate"), volatile=True
        ),
        "mode_shape": Variable(
            "displacement of a degree of freedom per coordinate",
            dims=("degree_of_freedom", "coordinate"),
            volatile=True,
        ),
        **{
            f"contact_{name}_{way}": Variable(
                f"{name} of the contact {way} the belt",
                units,
                ("time", "contact"),
                volatile=True,
            )
            for name, units in (("displacement", "m"), ("velocity", "m s-1"))
            for way in ("along", "across")
        },
        "normal_force": Variable(
            "normal force", "N", ("time", "contact"), volatile=True
        ),
        "regime": flag(
            "regime of the contact", Regime, "time", "contact", volatile=True
        ),
        "preload": Variable("preload of the contact", "N", ("contact",)),
        "attractor": count("attractor of squealing_modes that the motion is on"),
        "dominant_frequency": or_nan("strongest line of the motion", "Hz", rtol=1e-3),
        **mesh_entries,
        "outcome": outcome(among=(Outcome.converged, Outcome.not_computed)),
    },
)
