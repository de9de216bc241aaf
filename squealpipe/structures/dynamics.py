"""The matrices of a structure's equations of motion, divided by its mass, and its parameters."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy.linalg as la

from squealpipe.laws import friction_laws
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.friction import Friction, has_own_mu
from squealpipe.structures.modes import modal_damping_of


@dataclass(frozen=True, eq=False)
class Numbers:
    """Constants of the equations of motion besides parameters; n states of c contacts.

    Attributes:
        stiffness: M⁻¹ (K + Σ kᵢ nᵢnᵢᵀ), (n, n): diagonal in coordinates of modes.
        damping: M⁻¹ C, (n, n).
        load: M⁻¹ f, (n,); with a factor of preload of 1 where ``balanced``.
        normals, tangentials: (n, c).
        pushes, drags: M⁻¹ n and M⁻¹ t, (n, c).
        by_speed: M⁻¹ times each part of ``stiffness`` or ``damping`` that changes with speed, with
            which of both it is part of and its power. Both hold them at the structure's own speed.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    load: np.ndarray
    balanced: bool
    normals: np.ndarray
    tangentials: np.ndarray
    pushes: np.ndarray
    drags: np.ndarray
    by_speed: list[tuple[str, np.ndarray, int]]

    @classmethod
    def of(cls, structure: ContactStructure) -> Self:
        """Return the numbers of a structure of few degrees of freedom."""
        factor = la.cho_factor(structure.mass.toarray())
        scaled = structure.normals * structure.stiffnesses
        stiffness = structure.stiffness.toarray() + scaled @ structure.normals.T
        damping = structure.damping.toarray()
        if (modal := modal_damping_of(structure)) is not None:
            damping = damping + modal.product(np.eye(structure.size))
        return cls(
            stiffness=la.cho_solve(factor, _without_round_off(stiffness)),
            damping=la.cho_solve(factor, _without_round_off(damping)),
            load=la.cho_solve(factor, structure.load),
            balanced=structure.given_load is None,
            normals=structure.normals,
            tangentials=structure.tangentials,
            pushes=la.cho_solve(factor, structure.normals),
            drags=la.cho_solve(factor, structure.tangentials),
            by_speed=[
                (what, la.cho_solve(factor, matrix.toarray()), power)
                for what in ("stiffness", "damping")
                for matrix, power in getattr(structure.speed_terms, what)
                if power
            ],
        )


def _without_round_off(matrix: np.ndarray) -> np.ndarray:
    """A matrix without entries that are nothing beside the diagonal: modes are not coupled."""
    size = np.sqrt(np.abs(np.diag(matrix)))
    # couplings below this share of what they couple are round-off, and are left out
    limit = 1e-15 * len(matrix) * np.outer(size, size)
    return np.where(np.abs(matrix) <= limit, 0.0, matrix)


def law_in_use(friction: Friction) -> str:
    """The friction law; one that falls from μ to μ is Coulomb's."""
    law = friction.friction_law
    if law in friction_laws.FALLING and friction.mu_static is None:
        return friction_laws.COULOMB
    return law


def reads_speed(friction: Friction) -> bool:
    """Return whether ``friction_speed`` is a parameter of the law in use."""
    law = friction_laws.LAWS.get(law_in_use(friction))
    return law is not None and "friction_speed" in law.PARAMETERS


def coefficients_of(structure: ContactStructure, place: int) -> dict[str, float]:
    """Return the parameters ``mu`` and ``mu_static`` of one contact by their names in a system.

    Those of a contact's own begin with its name, like ``p1_mu``.
    """
    contact, friction = structure.contacts[place], structure.frictions[place]
    name = f"{contact.name}_mu" if has_own_mu(contact) else "mu"
    parameters = {name: friction.mu}
    if friction.mu_static is not None:
        is_own = contact.mu_static is not None
        parameters[f"{contact.name}_mu_static" if is_own else "mu_static"] = (
            friction.mu_static
        )
    return parameters
