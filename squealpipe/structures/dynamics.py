"""The equations of motion of a structure, divided by its mass, as functions of a system.

Contact i is described by constants of its regime: ``contact`` (1 or 0), ``direction`` (sgn wᵢ in
slip, else 0) and ``stick`` (1 or 0). Sticking contacts S share the linear system
(t_Sᵀ M⁻¹ t_S) T_S = −t_Sᵀ M⁻¹ (all other forces). Its matrix is masked by ``stick`` to one of
full size, whose inverse holds constants alone and so is computed when a regime is entered.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any, Self

import numpy as np
import scipy.linalg as la

from squealpipe.laws import friction_laws
from squealpipe.laws.friction import slip_force, stick_limit
from squealpipe.laws.tables import is_table
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
        mobility: tᵀM⁻¹t, (c, c).
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
    mobility: np.ndarray
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
        drags = la.cho_solve(factor, structure.tangentials)
        return cls(
            stiffness=la.cho_solve(factor, _without_round_off(stiffness)),
            damping=la.cho_solve(factor, _without_round_off(damping)),
            load=la.cho_solve(factor, structure.load),
            balanced=structure.given_load is None,
            normals=structure.normals,
            tangentials=structure.tangentials,
            pushes=la.cho_solve(factor, structure.normals),
            drags=drags,
            mobility=structure.tangentials.T @ drags,
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


class Motion:
    """Forces and rates at a state ``s``, with parameters ``p`` and regimes ``r``."""

    def __init__(
        self, structure: ContactStructure, numbers: Numbers, s: Any, p: Any, r: Any
    ) -> None:
        self.structure, self.numbers, self.p = structure, numbers, p
        self.regimes = [getattr(r, contact.name) for contact in structure.contacts]
        places = range(1, structure.size + 1)
        self.displacements = [getattr(s, f"q{i}") for i in places]
        self.velocities = [getattr(s, f"v{i}") for i in places]

    @cached_property
    def lifts(self) -> list[Any]:
        """nᵀq of each contact, m."""
        return [total(n, self.displacements) for n in self.numbers.normals.T]

    @cached_property
    def pressing(self) -> list[Any]:
        """Preload − stiffness · nᵀq of each contact: its normal force while that is positive, N."""
        return [
            contact.preload * self.p.preload - contact.stiffness * lift
            for contact, lift in zip(self.structure.contacts, self.lifts, strict=True)
        ]

    @cached_property
    def normal_forces(self) -> list[Any]:
        """N of each contact, N."""
        return [
            regime.contact * force
            for regime, force in zip(self.regimes, self.pressing, strict=True)
        ]

    @cached_property
    def sliding_speeds(self) -> list[Any]:
        """w = speed · belt_speed − tᵀq̇ of each contact, m/s."""
        return [
            contact.speed * self.p.belt_speed + total(-t, self.velocities)
            for contact, t in zip(
                self.structure.contacts, self.numbers.tangentials.T, strict=True
            )
        ]

    @cached_property
    def limits(self) -> list[Any]:
        """The largest friction that holds each contact, N."""
        return [
            stick_limit(force, friction_at(self.structure, index, self.p))
            for index, force in enumerate(self.pressing)
        ]

    @cached_property
    def slip_friction(self) -> list[Any]:
        """T of each contact that slips, N; 0 in stick."""
        forces = []
        contacts = zip(
            self.regimes, self.normal_forces, self.sliding_speeds, strict=True
        )
        for index, (regime, force, speed) in enumerate(contacts):
            law = friction_at(self.structure, index, self.p, regime)
            coefficient = law.factor * friction_laws.coefficient(
                regime.direction * speed, law
            )
            forces.append(slip_force(force, regime.direction, coefficient))
        return forces

    @cached_property
    def pulls(self) -> list[Any]:
        """tᵀM⁻¹ (all forces but friction in stick) of each contact, m/s²."""
        n = self.numbers
        return [
            self._along(t) + total(row, self.slip_friction)
            for t, row in zip(n.tangentials.T, n.mobility, strict=True)
        ]

    def _along(self, direction: np.ndarray) -> Any:
        """A component of M⁻¹ (all forces but friction), m/s²."""
        n = self.numbers
        load = float(direction @ n.load)
        return (
            load * (self.p.preload if n.balanced else 1.0)
            + total(-direction @ n.stiffness, self.displacements)
            + total(-direction @ n.damping, self.velocities)
            + total(direction @ n.pushes, self._relieved)
            + sum(self._by_speed(direction))
        )

    def _by_speed(self, direction: np.ndarray) -> Iterable[Any]:
        """Yield components of what other speeds than the structure's own change, m/s²."""
        terms = self.structure.speed_terms
        for what, matrix, power in self.numbers.by_speed:
            ratio = self.p.belt_speed * (1.0 / terms.reference)
            change = ratio**power - terms.factor(power, self.structure.belt_speed)
            of_what = self.displacements if what == "stiffness" else self.velocities
            yield change * total(-direction @ matrix, of_what)

    @cached_property
    def _relieved(self) -> list[Any]:
        """N + stiffness · nᵀq of each contact: the preload in contact, N."""
        relieved = []
        for contact, regime, lift in zip(
            self.structure.contacts, self.regimes, self.lifts, strict=True
        ):
            closed = regime.contact * (contact.preload * self.p.preload)
            relieved.append(closed + (1.0 - regime.contact) * contact.stiffness * lift)
        return relieved

    @cached_property
    def _held(self) -> list[list[Any]]:
        """(t_Sᵀ M⁻¹ t_S)⁻¹ over the contacts S that stick, 0 elsewhere, kg."""
        masks = [regimes.stick for regimes in self.regimes]
        matrix = [
            [
                masks[i] * masks[j] * float(value) + (i == j) * (1.0 - masks[i])
                for j, value in enumerate(row)
            ]
            for i, row in enumerate(self.numbers.mobility)
        ]
        inverse = inverse_of(matrix)
        return [
            [masks[i] * masks[j] * value for j, value in enumerate(row)]
            for i, row in enumerate(inverse)
        ]

    @cached_property
    def stick_friction(self) -> list[Any]:
        """T of each contact that sticks, N; 0 in slip."""
        return [-total(row, self.pulls) for row in self._held]

    @cached_property
    def accelerations(self) -> list[Any]:
        """q̈."""
        friction = [
            slip + stick
            for slip, stick in zip(self.slip_friction, self.stick_friction, strict=True)
        ]
        return [
            self._along(unit) + total(row, friction)
            for unit, row in zip(
                np.eye(self.structure.size), self.numbers.drags, strict=True
            )
        ]

    def holding(self, place: int) -> Any:
        """The friction that would keep a contact on the belt, others staying as they are.

        What slip friction lacks to it is the acceleration that is left, over the mobility with the
        contacts held that stick. In stick it is the friction there is.
        """
        row = self.numbers.mobility[place]
        held = [total(row, [each[j] for each in self._held]) for j in range(len(row))]
        # held itself it has no mobility, and nothing is left to accelerate it
        free = float(row[place]) * (1.0 + self.regimes[place].stick)
        mobility = free - total(row, held)
        acceleration = self.pulls[place] - total(held, self.pulls)
        friction = self.slip_friction[place] + self.stick_friction[place]
        return friction - acceleration * mobility**-1.0


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


def friction_at(
    structure: ContactStructure, place: int, p: Any, regime: Any = None
) -> Any:
    """Return what friction laws read of a contact: parameters and, of a table, the piece of a
    regime.
    """
    friction = structure.frictions[place]
    law = law_in_use(friction)
    mu, static, *_ = [
        *(getattr(p, name) for name in coefficients_of(structure, place)),
        None,
    ]
    q = SimpleNamespace(mu=mu, mu_static=static, friction_law=law, factor=1.0)
    q.friction_speed = (
        p.friction_speed if reads_speed(friction) else friction.friction_speed
    )
    q.static_mu = friction_laws.static_coefficient(q)
    if is_table(law):
        q.factor = mu
        q.static_mu = q.static_mu if static is not None else mu * q.static_mu
        if regime is not None:
            coefficients = (regime.mu_c0, regime.mu_c1, regime.mu_c2, regime.mu_c3)
            q.friction_law = friction_laws.FrictionPiece(regime.mu_start, coefficients)
    return q


def total(coefficients: Iterable[Any], values: Sequence[Any]) -> Any:
    """Σ c x without terms whose coefficient is 0."""
    summed: Any = 0.0
    for coefficient, value in zip(coefficients, values, strict=True):
        if isinstance(coefficient, float):
            coefficient = float(coefficient)
            if coefficient == 0.0:
                continue
        summed = summed + coefficient * value
    return summed


def inverse_of(matrix: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """The inverse of a symmetric positive definite matrix of any numbers, by Gauss and Jordan."""
    size = len(matrix)
    rows = [
        [*row, *(float(i == j) for j in range(size))] for i, row in enumerate(matrix)
    ]
    for i in range(size):
        scale = rows[i][i] ** -1.0
        rows[i] = [scale * value for value in rows[i]]
        for k in range(size):
            if k != i:
                factor = rows[k][i]
                rows[k] = [
                    value - factor * pivot
                    for value, pivot in zip(rows[k], rows[i], strict=True)
                ]
    return [row[size:] for row in rows]
