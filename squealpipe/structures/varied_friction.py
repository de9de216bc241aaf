"""Coefficients of friction that one number stands for: the structure's, a face's, or a factor."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from squealpipe.structures.contact import face_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.systems.inputs.values import brief, numbers_in_si
from squealpipe.systems.inputs.words import suggestion


@dataclass(frozen=True)
class VariedFriction:
    """A number for the coefficient of some contacts, the others as they are.

    Attributes:
        contacts: mask of the contacts whose coefficient it is; all of them where it is a factor.
        name: of the contact or face; None: the contacts without a coefficient of their own.
        is_factor: whether it multiplies the coefficients instead.
    """

    contacts: np.ndarray
    name: str | None = None
    is_factor: bool = False

    @classmethod
    def common(cls, structure: ContactStructure) -> Self:
        """Return the structure's coefficient."""
        return cls(~structure.has_own_mu)

    @classmethod
    def factor(cls, structure: ContactStructure) -> Self:
        """Return the factor of the coefficients of all contacts."""
        return cls(np.ones(len(structure.contacts), bool), is_factor=True)

    @classmethod
    def named(cls, structure: ContactStructure, name: str) -> Self:
        """Return the coefficient of a contact, or of a face: contacts ``<name>_1``, ….

        Raises:
            ValueError: there is no such contact or face.
        """
        names = [contact.name for contact in structure.contacts]
        chosen = np.array([each == name for each in names], bool)
        if not chosen.any():
            chosen = np.array([face_of(each) == name for each in names], bool)
        if not chosen.any():
            known = [*names, *dict.fromkeys(filter(None, map(face_of, names)))]
            raise ValueError(
                f"mu: there is no contact or face {name!r}; {suggestion(name, known)}"
            )
        return cls(chosen, name)

    def of_contacts(self, structure: ContactStructure, number: float) -> np.ndarray:
        """Return the coefficient of each contact, (contacts,)."""
        own = structure.mu_of_contacts
        return number * own if self.is_factor else np.where(self.contacts, number, own)

    def changed(
        self, structure: ContactStructure, number: float, limit: float = 1.0
    ) -> ContactStructure:
        """Return the structure with a coefficient of these contacts' own, or a factor of each.

        Args:
            limit: factor of their limits of stick, which stay also where they are the structure's.
        """
        contacts = [
            replace(
                contact,
                mu=float(mu),
                mu_static=friction.mu_static and limit * friction.mu_static,
            )
            if chosen
            else contact
            for contact, friction, mu, chosen in zip(
                structure.contacts,
                structure.frictions,
                self.of_contacts(structure, number),
                self.contacts,
                strict=True,
            )
        ]
        return structure.with_(contacts=contacts)

    def now(self, structure: ContactStructure) -> float:
        """Return the number that the structure has.

        Raises:
            ValueError: the contacts of a face have different coefficients.
        """
        if self.is_factor:
            return 1.0
        if self.name is None:
            return structure.mu
        values = np.unique(structure.mu_of_contacts[self.contacts])
        if len(values) > 1:
            raise ValueError(
                f"mu: the contacts of {self.name} have different coefficients, {values[0]:g} to "
                f"{values[-1]:g}; give mu={{{self.name!r}: …}} a number or an array"
            )
        return float(values[0])


def varied_by(structure: ContactStructure, mu: Any) -> tuple[VariedFriction, Any]:
    """Read the argument ``mu`` of complex modes.

    Args:
        mu: None, a number or an array for the structure's, or a mapping from the name of one
            contact or face to these.

    Returns:
        What is varied, and its values as they were written.

    Raises:
        ValueError: nothing has what is to be varied.
    """
    all_own = bool(structure.contacts) and bool(structure.has_own_mu.all())
    if isinstance(mu, Mapping):
        if len(mu) != 1:
            raise ValueError(
                f"mu = {brief(dict(mu))}: one contact or face at a time is varied; give the others "
                "their mu in the structure"
            )
        ((name, values),) = mu.items()
        values = numbers_in_si("mu", values, "1")
        varied = VariedFriction.named(structure, str(name))
        return varied, varied.now(structure) if values is None else values
    if mu is None:
        varied = (VariedFriction.factor if all_own else VariedFriction.common)(
            structure
        )
        return varied, varied.now(structure)
    if all_own:
        names = [contact.name for contact in structure.contacts]
        one = next(filter(None, map(face_of, names)), names[0])
        raise ValueError(
            f"mu = {brief(mu)}: every contact has a mu of its own, so that none has the "
            f"structure's; vary one, like mu={{{one!r}: …}}, or leave mu out to scale all together"
        )
    return VariedFriction.common(structure), mu
