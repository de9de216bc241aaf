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

QUASI_STATIC_MAP = DatasetSchema(
    name="quasi_static_map",
    title="Quasi-static sliding (model A2) and the linear static state over both spring angles",
    coordinates=ANGLES,
    variables={
        "possible_as_printed": Variable(
            dims=MAP, dtype="bool", long_name="Eq. (11) as printed holds"
        ),
        "possible": Variable(
            dims=MAP, dtype="bool", long_name="reaction force of model A2 is positive"
        ),
        "reaction_force": Variable(
            dims=MAP, units="N", nan_allowed=True, long_name="reaction force of model A2, y = 0"
        ),
        "x_static": Variable(
            dims=MAP, units="m", nan_allowed=True, long_name="x of the static state of Eq. (15)"
        ),
        "y_static": Variable(
            dims=MAP, units="m", nan_allowed=True, long_name="y of the static state of Eq. (15)"
        ),
        "contact_force_static": Variable(
            dims=MAP,
            units="N",
            nan_allowed=True,
            long_name="contact force of the static state of Eq. (15), negative where k3 pulls",
        ),
        "outcome": outcome(*MAP),
    },
)

NATURAL_FREQUENCIES = DatasetSchema(
    name="natural_frequencies",
    title="Natural frequencies of model A4, in contact and separated",
    coordinates={
        **ANGLES,
        **MODES,
        "contact_state": Variable(
            dims=("contact_state",), dtype="U", long_name="state of the contact"
        ),
    },
    variables={
        "omega": Variable(
            dims=(*MAP, "mode", "contact_state"),
            units="rad s-1",
            long_name="natural frequency",
        ),
        "outcome": outcome(*MAP, "mode", "contact_state"),
    },
)


class Boundary(IntEnum):
    """Which curve a boundary point belongs to."""

    flutter = 0
    divergence = 1
    reaction_changes_sign = 2
    no_coupling = 3


STABILITY_BOUNDARIES = DatasetSchema(
    name="stability_boundaries",
    title="Exact boundaries of flutter, divergence and quasi-static sliding",
    coordinates={
        "point": Variable(dims=("point",), dtype="i4", long_name="number of the point"),
    },
    variables={
        "alpha1": Variable(
            dims=("point",), units="rad", long_name="angle of spring 1, continuous along a segment"
        ),
        "alpha2": Variable(
            dims=("point",), units="rad", long_name="angle of spring 2, continuous along a segment"
        ),
        "z_real": Variable(
            dims=("point",), units="N m-1", long_name="Re(k1 exp(2i alpha1) + k2 exp(-2i alpha2))"
        ),
        "z_imag": Variable(
            dims=("point",), units="N m-1", long_name="Im(k1 exp(2i alpha1) + k2 exp(-2i alpha2))"
        ),
        "boundary": Variable(
            dims=("point",), dtype="i1", flags=Boundary, long_name="which boundary"
        ),
        "segment": Variable(
            dims=("point",), dtype="i4", long_name="points of one number are joined by a line"
        ),
    },
)

PAIR = ("mu", "kappa")


def _share(dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(dims=dims, long_name=f"share of the angle map: {long_name}")


LINEAR_SHARES = DatasetSchema(
    name="linear_shares",
    title="How much of the angle map the linear models forbid or find unstable",
    coordinates={
        "mu": Variable(dims=("mu",), long_name="friction coefficient"),
        "kappa": Variable(dims=("kappa",), long_name="k3/k1"),
        "sharpness": Variable(dims=("sharpness",), long_name="sigma times l_pre"),
    },
    variables={
        "impossible_as_printed": _share(("mu",), "Eq. (11) as printed fails"),
        "impossible": _share(("mu",), "reaction force of model A2 is not positive"),
        "flutter": _share(PAIR, "flutter"),
        "divergence": _share(PAIR, "divergence"),
        "pulled": _share(PAIR, "k3 pulls in the static state of Eq. (15)"),
        "impossible_but_pressed": _share(
            PAIR, "not possible by model A2, contact force of Eq. (15) positive"
        ),
        "unstable_where_possible": _share(PAIR, "unstable where sliding is possible"),
        "stiffness_ratio": Variable(dims=("sharpness",), long_name="K3 of Eq. (8d) over k3"),
        "flutter_regularized": _share(("sharpness",), "flutter with K3 of Eq. (8d)"),
        "divergence_regularized": _share(("sharpness",), "divergence with K3 of Eq. (8d)"),
    },
)

MODE_COUPLING = DatasetSchema(
    name="mode_coupling",
    title="Minimal mode-coupling model of Hoffmann, Fischer, Allgaier and Gaul (2002) by model A3",
    coordinates={
        "mu": Variable(dims=("mu",), long_name="friction coefficient"),
        **MODES,
        "distance": Variable(
            dims=("distance",), long_name="relative distance of mu from the onset of flutter"
        ),
        "side": Variable(dims=("side",), dtype="U", long_name="side of the onset"),
    },
    variables={
        "growth_rate": Variable(dims=("mu",), units="s-1", long_name="largest real part by A3"),
        "frequency": Variable(dims=("mu", "mode"), units="rad s-1", long_name="frequency by A3"),
        "published_growth_rate": Variable(
            dims=("mu",), units="s-1", long_name="largest real part by the published model"
        ),
        "published_frequency": Variable(
            dims=("mu", "mode"), units="rad s-1", long_name="frequency by the published model"
        ),
        "closed_form_error": Variable(
            dims=("side", "distance"),
            atol=1e-11,
            long_name="relative error of the eigenvalues by A3, against 60 digits",
        ),
        "numeric_error": Variable(
            dims=("side", "distance"),
            atol=1e-6,
            long_name="relative error of numeric eigenvalues, against 60 digits",
        ),
    },
)
