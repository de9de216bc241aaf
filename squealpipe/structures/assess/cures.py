"""Changes of a structure that may stop its noise, each with the range over which it is searched."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from squealpipe.structures.assess.designs import Design
from squealpipe.structures.assess.modifications import Modification, read_modification
from squealpipe.structures.contact import face_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.factors import with_factors
from squealpipe.structures.varied_friction import VariedFriction
from squealpipe.vibration.boundaries import Cure


@dataclass(frozen=True)
class Ranges:
    """Ranges in which cures are looked for; each comment says what another value would do."""

    factor: float = 10.0
    """Largest factor of stiffness, preload or speed, either way."""
    friction: float = 3.0
    """Largest factor of friction, or coefficient 1 where that is more; it goes down to 0."""
    damping: float = 0.2
    """Largest damping ratio of the modes."""
    ratio: float = 1.12
    """Factor between values that are looked at first. 1.06: shorter stretches of quiet are seen,
    at twice the cost."""
    steps: int = 16
    """Amounts of a modification that are looked at first."""


def cures_of(
    design: Design, modifications: Mapping[str, Any]
) -> tuple[dict[str, Cure], dict[str, str]]:
    """Return all cures of a structure by name, and their units.

    Args:
        modifications: name → what is added, see :func:`.read_modification`.

    Raises:
        ValueError: a modification that cannot be read, or has the name of another cure.
    """
    whole = design.whole
    # stiffness and preload are changed by a factor
    unit_of = {
        "mu": "1",
        "contact_stiffness": "1",
        "preload": "1",
        "modal_damping": "1",
        "belt_speed": "m s-1",
    }
    cures, units = _frictions(design), dict(unit_of)
    units |= dict.fromkeys(cures, "1")
    if whole.rotation is not None:
        units["belt_speed"] = "rad s-1"
    cures["contact_stiffness"] = _factor(
        design, lambda each, factor: with_factors(each, {"contact_stiffness": factor})
    )
    cures["preload"] = _factor(design, with_preload)
    cures["modal_damping"] = _damping(design)
    speed, factors = whole.belt_speed, _factors(Ranges.factor)
    cures["belt_speed"] = Cure(
        speed, _sliding(design, "belt_speed"), speed / factors, speed * factors
    )
    for name, content in modifications.items():
        if name in cures:
            raise ValueError(
                f"modifications: {name!r} is the name of a cure; rename it"
            )
        change = read_modification(name, content, design.given, _leading(design))
        amounts = change.most * np.linspace(0.0, 1.0, Ranges.steps + 1)[1:]
        cures[name] = Cure(
            0.0, _modified(design, change), np.zeros(0), amounts, of_none=change.most
        )
        units[name] = change.unit
    return cures, {name: units[name] for name in cures}


def _leading(design: Design) -> float:
    """Return the frequency of the mode that grows fastest, Hz."""
    plant = design.plant
    assert plant is not None  # noqa: S101 (without sliding there are no cures)
    values = plant.spectrum.values
    return float(values[values.real.argmax()].imag / (2.0 * np.pi))


def _factors(most: float) -> np.ndarray:
    """Return factors from just above 1 to the largest."""
    count = 1 + int(np.ceil(np.log(most) / np.log(Ranges.ratio)))
    return np.geomspace(1.0, most, count)[1:]


Change = Callable[[ContactStructure, float], ContactStructure]


def _whole(design: Design, change: Change) -> Callable[[float], Design]:
    """Return the design whose whole structure is changed, remembered by the value."""

    @lru_cache(maxsize=512)
    def apply(value: float) -> Design:
        return design.changed(change(design.whole, value))

    return apply


def _modified(design: Design, change: Modification) -> Callable[[float], Design]:
    """Return the design with some amount of a modification, remembered by the amount."""
    ready = design.ready_for(lambda given: change.of(given, change.most))

    @lru_cache(maxsize=512)
    def apply(amount: float) -> Design:
        if amount == 0.0:
            return ready
        return ready.modified(lambda given: change.of(given, amount))

    return apply


def _sliding(design: Design, name: str) -> Callable[[float], Design]:
    """Return the design with another friction or speed, in which the modes at rest stay."""

    @lru_cache(maxsize=512)
    def apply(value: float) -> Design:
        return design.slid(**{name: value})

    return apply


def _factor(design: Design, change: Change) -> Cure:
    factors = _factors(Ranges.factor)
    return Cure(1.0, _whole(design, change), 1.0 / factors, factors)


def with_preload(structure: ContactStructure, factor: float) -> ContactStructure:
    """Everything that presses, times a factor: preloads, and a load that is given."""
    contacts = [contact.scaled(preload=factor) for contact in structure.contacts]
    load = structure.given_load
    scaled = None if load is None else factor * np.asarray(load, float)
    return structure.with_(contacts=contacts, load=scaled)


def _damping(design: Design) -> Cure:
    """Return damping of all modes; where they have ratios of their own the mean is changed."""
    ratios = design.whole.modal_damping
    mean = float(np.mean(ratios))

    def change(structure: ContactStructure, value: float) -> ContactStructure:
        if not np.ndim(ratios):
            return structure.with_(modal_damping=value)
        shifted = np.maximum(np.asarray(ratios) + (value - mean), 0.0)
        return structure.with_(modal_damping=shifted.tolist())

    least = max(mean, 1e-4)
    above = np.geomspace(least, max(Ranges.damping, 2.0 * least), 40)
    below = np.append(mean / _factors(Ranges.factor), 0.0) if mean else np.zeros(0)
    return Cure(
        mean,
        _whole(design, change),
        below,
        above[above > mean],
        of_none=float(above.max()),
    )


def _frictions(design: Design) -> dict[str, Cure]:
    """Return the structure's friction, and that of each face or contact that has its own."""
    whole, cures = design.whole, {}
    own = whole.has_own_mu
    if not own.all():
        cures["mu"] = _friction(whole.mu, _sliding(design, "mu"), whole.largest_mu)
    names = [face_of(contact.name) or contact.name for contact in whole.contacts]
    groups = dict.fromkeys(
        name for name, is_own in zip(names, own, strict=True) if is_own
    )
    if len(dict.fromkeys(names)) > 1 and any(
        face_of(contact.name) for contact in whole.contacts
    ):
        groups = dict.fromkeys(names)  # faces side by side are changed one by one
    for name in groups:
        varied = VariedFriction.named(whole, name)
        values = np.unique(whole.mu_of_contacts[varied.contacts])
        if len(values) > 1:
            continue  # contacts of one face with different coefficients are changed together
        limits = [
            friction.largest_mu
            for friction, chosen in zip(whole.frictions, varied.contacts, strict=True)
            if chosen
        ]
        cures[f"mu_{name}"] = _friction(
            float(values[0]), _whole(design, varied.changed), min(limits)
        )
    return cures


def _friction(mu: float, apply: Callable[[float], Design], largest: float) -> Cure:
    if mu == 0.0:
        above = np.linspace(0.0, 1.0, 26)[1:]
        return Cure(mu, apply, np.zeros(0), above[above <= largest])
    above = mu * _factors(max(Ranges.friction, 1.0 / mu))
    below = np.append(mu / _factors(Ranges.factor), 0.0)
    return Cure(mu, apply, below, above[above <= largest])
