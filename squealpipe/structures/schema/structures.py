"""Complex modes of structures, at one friction and belt speed or over some."""

import re
from enum import IntEnum

from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    whether,
)
from squealpipe.schema.meshes import mesh_coordinates, mesh_entries

NAME = "complex_modes"
FACTORS = {
    "mu": ("coefficient of friction", "1"),
    "belt_speed": ("belt speed", "m s-1"),
}
"""Dimensions over which modes are always computed."""
MODES_ARGUMENTS = {
    "mu_static": ("limit of friction in stick", "1"),
    "friction_speed": ("speed at which friction falls", "m s-1"),
    "modal_damping": ("damping ratio of modes", "1"),
}
"""Arguments of a structure that can be factors too: their values."""
SCALED = {
    "preload": "factor of all preloads",
    "contact_stiffness": "factor of all contact stiffnesses",
    "mass": "factor of the mass matrix",
    "damping": "factor of the damping matrix",
    "stiffness": "factor of the stiffness matrix",
}
OF_CONTACT = {
    "preload": "factor of the preload",
    "stiffness": "factor of the stiffness",
}
"""Quantities of one contact that can be factors, named ``<contact>_preload``."""


class Onset(IntEnum):
    """Reason why a critical friction is what it is."""

    stable = 0
    located = 1
    unstable_throughout = 2
    not_followed = 3
    not_sought = 4


class SpeedOnset(IntEnum):
    """Reason why a critical speed is what it is."""

    stable = 0
    turns_unstable = 1
    unstable_throughout = 2
    not_followed = 3
    turns_stable = 4


def modes_over(dims: tuple[str, ...]) -> DatasetSchema:
    """Return the schema of modes over these factors."""
    mode, contact = (*dims, "mode"), (*dims, "contact")
    along = tuple(dim for dim in dims if dim != "mu")
    across = tuple(dim for dim in dims if dim != "belt_speed")
    return DatasetSchema(
        name=f"{NAME} over {', '.join(dims)}" if dims else NAME,
        title="Complex modes of a structure about steady sliding",
        coordinates={
            "mode": count("mode, by ascending frequency at the first friction", "mode"),
            **{
                key: Variable(
                    words,
                    unit,
                    (key,) if key in dims else (),
                    # absent where every contact has its own
                    optional=key == "mu" and key not in dims,
                )
                for key, (words, unit) in FACTORS.items()
            },
            **{key: _factor(key) for key in dims if key not in FACTORS},
            "contact": Variable(
                "name of the contact", dims=("contact",), dtype="U", optional=True
            ),
            **mesh_coordinates,
        },
        variables={
            "growth_rate": or_nan(
                "growth rate, real part of the eigenvalue",
                "s-1",
                mode,
                rtol=1e-6,
                atol=1e-6,
            ),
            "growth_rate_error": or_nan(
                "bound of the growth rate's error", "s-1", mode, volatile=True
            ),
            "frequency": or_nan("frequency", "Hz", mode, rtol=1e-8),
            "damping_ratio": or_nan(
                "damping ratio, negative growth rate over |s|", "1", mode, rtol=1e-6
            ),
            "unstable": whether("grows by more than the error", *mode),
            "residual": or_nan("relative residual", "1", mode, volatile=True),
            "outcome": outcome(
                *mode,
                among=(
                    Outcome.converged,
                    Outcome.not_computed,
                    Outcome.rigid_mode,
                    Outcome.no_sliding_state,
                ),
            ),
            "critical_mu": or_nan(
                "smallest friction at which growth leaves zero",
                "1",
                (*along, "mode"),
                rtol=1e-8,
            ),
            "critical_scale": or_nan(
                "smallest factor of all coefficients of friction at which growth leaves zero",
                "1",
                (*along, "mode"),
                rtol=1e-8,
                optional=True,
            ),
            "onset": flag(
                "why the critical friction is what it is", Onset, *along, "mode"
            ),
            "merges_with": count(
                "mode that this one meets by frequency where one of both turns unstable, the first "
                "of several; 0: none",
                *along,
                "mode",
            ),
            **(
                {
                    "critical_speed": or_nan(
                        "smallest speed at which growth passes zero",
                        "m s-1",
                        (*across, "mode"),
                        rtol=1e-8,
                        optional=True,
                    ),
                    "speed_onset": flag(
                        "why the critical speed is what it is",
                        SpeedOnset,
                        *across,
                        "mode",
                        optional=True,
                    ),
                }
                if "belt_speed" in dims
                else {}
            ),
            "normal_force": or_nan(
                "normal force in steady sliding, 0 where open",
                "N",
                contact,
                optional=True,
            ),
            **{
                f"shape_{part}": or_nan(
                    f"{part} part of the mode's shape at one friction and speed, largest 1",
                    "1",
                    ("mode", "degree_of_freedom"),
                    dtype="f4",
                    optional=True,
                    volatile=True,
                )
                for part in ("real", "imaginary")
            },
            "shape_mu": Variable(
                "value along mu at which the shapes are", optional=True
            ),
            "shape_belt_speed": Variable(
                "belt speed at which the shapes are", "m s-1", optional=True
            ),
            **mesh_entries,
        },
    )


complex_modes_schemas = tuple(
    modes_over(dims) for dims in ((), ("mu",), ("belt_speed",), ("mu", "belt_speed"))
)


def _factor(name: str) -> Variable:
    """Table entry of a further factor."""
    if name in MODES_ARGUMENTS:
        return Variable(*MODES_ARGUMENTS[name], (name,))
    contact, _, what = name.rpartition("_")
    words = SCALED.get(name) or f"{OF_CONTACT[what]} of contact {contact}"
    return Variable(words, "1", (name,))


def derived(name: str) -> DatasetSchema | None:
    """The schema of that name if it is one of modes over further factors."""
    pattern = re.compile(rf"^{NAME} over (?P<dims>\w+(?:, \w+)*)$")
    match = pattern.match(name)
    if match is None:
        return None
    dims = tuple(match["dims"].split(", "))
    for dim in dims:
        contact, _, what = dim.rpartition("_")
        if dim not in FACTORS | MODES_ARGUMENTS | SCALED and not (
            contact and what in OF_CONTACT
        ):
            return None
    return modes_over(dims)
