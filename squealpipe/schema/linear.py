"""Datasets of the linear models A2, A3 and of the natural frequencies."""

from __future__ import annotations

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Variable, outcome

MAP = ("alpha1", "alpha2")

ANGLES = {
    "alpha1": Variable(dims=("alpha1",), units="rad", long_name="angle of spring 1"),
    "alpha2": Variable(dims=("alpha2",), units="rad", long_name="angle of spring 2"),
}
MODES = {"mode": Variable(dims=("mode",), dtype="i4", long_name="mode, by ascending frequency")}


class LinearRegimeFlag(IntEnum):
    """Meaning of regime_linear."""

    stable = 0
    flutter = 1
    divergence = 2


REGIME_LINEAR = Variable(
    dims=MAP, dtype="i1", flags=LinearRegimeFlag, long_name="stability regime of model A3"
)

STABILITY_MAP = DatasetSchema(
    name="stability_map",
    title="Linear stability (model A3) over both spring angles",
    coordinates={**ANGLES, **MODES},
    variables={
        "growth_rate": Variable(
            dims=MAP, units="s-1", long_name="largest real part of the eigenvalues"
        ),
        "frequency": Variable(
            dims=(*MAP, "mode"), units="rad s-1", long_name="imaginary part of the eigenvalues"
        ),
        "regime_linear": REGIME_LINEAR,
        "outcome": outcome(*MAP),
    },
)
