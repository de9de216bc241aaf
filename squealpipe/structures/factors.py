"""Quantities besides friction and belt speed over which modes are computed, and their structure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.schema.structures import MODES_ARGUMENTS, OF_CONTACT, SCALED
from squealpipe.structures.spectrum import Limits, check_frequency
from squealpipe.structures.varied_friction import VariedFriction, varied_by
from squealpipe.systems.inputs.values import brief, is_whole_number
from squealpipe.systems.inputs.words import suggestion
from squealpipe.validation import real_array


@dataclass(frozen=True)
class Asked:
    """Request of modes: the frictions, speeds and factors to compute them at.

    Attributes:
        mu, belt_speed: a number or a 1-D array each.
        friction: what ``mu`` stands for.
        varied: further factors that are arrays.
        fixed: those that are numbers.
        critical: whether critical frictions are sought.
    """

    limits: Limits
    mu: np.ndarray
    belt_speed: np.ndarray
    varied: dict[str, np.ndarray]
    fixed: dict[str, float]
    friction: VariedFriction
    critical: bool = True


def asked_of(
    structure: ContactStructure,
    factors: Mapping[str, Any],
    *,
    frequency_max: float | None = None,
    n_modes: int | None = None,
    critical: bool = True,
) -> Asked:
    """The arguments of ``complex_modes``; ``mu`` and ``belt_speed`` are factors too.

    Raises:
        ValueError: names the argument.
    """
    if not isinstance(critical, bool):
        raise ValueError(f"critical = {brief(critical)}: True or False is needed")  # noqa: TRY004
    further = dict(factors)
    mu, belt_speed = further.pop("mu", None), further.pop("belt_speed", None)
    friction, written = varied_by(structure, mu)
    frictions = real_line("mu", written)
    if (frictions < 0).any():
        raise ValueError(f"mu = {brief(mu)}: numbers of 0 or greater are needed")
    if frictions.ndim and (np.diff(frictions) <= 0).any():
        raise ValueError(f"mu = {brief(mu)}: it must ascend")
    speeds = real_line(
        "belt_speed", structure.belt_speed if belt_speed is None else belt_speed
    )
    for speed in np.atleast_1d(speeds).tolist():
        structure.at_speed(speed)  # refuses a speed at which a term has no value
    checked = checked_factors(structure, further)
    return Asked(
        _limits(structure, frequency_max, n_modes),
        frictions,
        speeds,
        {name: values for name, values in checked.items() if values.ndim},
        {name: float(values) for name, values in checked.items() if not values.ndim},
        friction,
        critical,
    )


def factors_of(structure: ContactStructure) -> list[str]:
    """Names of a structure's factors; those of one contact are ``<contact>_preload``, ….

    ``mu_static``, ``friction_speed`` and ``modal_damping`` are values of these arguments. The
    others multiply what the structure has: ``preload`` and ``contact_stiffness`` those of all
    contacts, ``mass``, ``damping`` and ``stiffness`` the matrices.
    """
    single = [
        f"{contact.name}_{what}"
        for contact in structure.contacts
        for what in OF_CONTACT
    ]
    return list(dict.fromkeys([*MODES_ARGUMENTS, *SCALED, *single]))


def checked_factors(
    structure: ContactStructure, given: Mapping[str, Any]
) -> dict[str, np.ndarray]:
    """Values of each factor, a number or a 1-D array.

    Raises:
        ValueError: an unknown name, or values that are not such numbers.
    """
    known = factors_of(structure)
    checked = {}
    for name, values in given.items():
        if name not in known:
            names = ["mu", "belt_speed", "frequency_max", "n_modes", "critical", *known]
            raise ValueError(f"{name!r} is unknown; {suggestion(name, names)}")
        checked[name] = real_line(name, values)
        if name in MODES_ARGUMENTS:
            continue  # the structure judges these
        may_vanish = name == "damping" or name.endswith("preload")
        least = "0 or greater" if may_vanish else "greater than 0"
        allowed = checked[name] >= 0 if may_vanish else checked[name] > 0
        if not allowed.all():
            raise ValueError(f"{name} = {brief(values)}: factors {least} are needed")
    return checked


def real_line(name: str, values: Any) -> np.ndarray:
    """A number, or a 1-D array of different ones.

    Raises:
        ValueError: names the argument.
    """
    array = real_array(name, values)
    if array.ndim > 1 or not array.size:
        raise ValueError(
            f"{name} has shape {array.shape}: a number or a 1-D array is needed"
        )
    if len(np.unique(array)) < array.size:
        raise ValueError(f"{name} = {brief(values)}: each value once is needed")
    return array


def with_factors(
    structure: ContactStructure, factors: Mapping[str, float]
) -> ContactStructure:
    """The structure with these values of factors."""
    if not factors:
        return structure
    changes: dict[str, Any] = {
        name: factors[name] for name in MODES_ARGUMENTS if name in factors
    }
    if "mass" in factors:
        changes["mass"] = structure.mass * factors["mass"]
    for name in ("damping", "stiffness"):
        if (factor := factors.get(name)) is not None:
            changes[name] = structure.arguments[name] * factor
            terms = changes.get("speed_terms", structure.speed_terms)
            changes["speed_terms"] = terms.mapped(
                lambda each, factor=factor: each * factor, name
            )
    return structure.with_(
        **changes,
        contacts=[
            contact.scaled(
                preload=factors.get("preload", 1.0)
                * factors.get(f"{contact.name}_preload", 1.0),
                stiffness=_stiffness(contact.name, factors),
            )
            for contact in structure.contacts
        ],
    )


def _stiffness(contact: str, factors: Mapping[str, float]) -> float:
    of_all, single = "contact_stiffness", f"{contact}_stiffness"
    names = {of_all, single}  # one and the same where a contact is named so
    return float(np.prod([factors.get(name, 1.0) for name in names]))


def _limits(
    structure: ContactStructure, frequency_max: float | None, n_modes: int | None
) -> Limits:
    check_frequency(frequency_max)
    if n_modes is not None and not (is_whole_number(n_modes) and n_modes >= 1):
        raise ValueError(
            f"n_modes = {brief(n_modes)}: a whole number from 1 on is needed"
        )
    if structure.size > DENSE and frequency_max is None and n_modes is None:
        raise ValueError(
            f"{structure.size} degrees of freedom: give frequency_max (Hz) or n_modes; all modes "
            f"are computed up to {DENSE}"
        )
    return Limits(
        None if frequency_max is None else float(frequency_max),
        None if n_modes is None else int(n_modes),
    )
