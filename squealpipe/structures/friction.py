"""The friction of the contacts of a structure, by the laws of :mod:`squealpipe.laws`."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from squealpipe.laws.friction_laws import COULOMB, LAWS, coefficient, slope
from squealpipe.laws.tables import is_table
from squealpipe.parameters import TABLE
from squealpipe.systems.inputs.values import brief

if TYPE_CHECKING:
    from squealpipe.structures.contact import Contact


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Coefficient over sliding speed; fields as in ``Parameters``.

    Attributes:
        mu: the coefficient of the law, or with a table a factor of it.
        mu_static: limit of stick; None: that of sliding at speed 0.
    """

    friction_law: str
    mu: float
    mu_static: float | None
    friction_speed: float

    def __post_init__(self) -> None:
        for name in ("mu", "friction_law", "mu_static", "friction_speed"):
            value = TABLE[name].check(name, getattr(self, name))
            object.__setattr__(self, name, value)
        if self.mu_static is not None and self.mu_static < self.onset:
            raise ValueError(
                f"mu_static = {self.mu_static!r}: it must be {self.onset!r}, the coefficient at "
                "speed 0, or greater"
            )

    @property
    def factor(self) -> float:
        """Factor of the law's coefficient: ``mu`` where the law is a table."""
        return self.mu if is_table(self.friction_law) else 1.0

    @property
    def onset(self) -> float:
        """The coefficient at speed 0 without a limit of stick."""
        if self.friction_law in LAWS:
            return self.mu
        return self.factor * float(coefficient(0.0, self))

    @property
    def static_mu(self) -> float:
        """Largest friction in stick over the normal force."""
        return self.onset if self.mu_static is None else self.mu_static

    @property
    def largest_mu(self) -> float:
        """The largest ``mu`` that the limit of stick allows, where one is given; else infinite."""
        if self.mu_static is None or not self.onset:
            return math.inf
        return self.mu * self.mu_static / self.onset

    def coefficient(self, speed: Any) -> Any:
        """μ(w) at sliding speeds w ≥ 0, m/s."""
        return self.factor * coefficient(speed, self)

    def slope(self, speed: Any) -> Any:
        """dμ/dw, s/m."""
        return self.factor * slope(speed, self)


def default_mu(friction_law: object) -> float:
    """``mu`` where none is given: 1, a factor, with a table."""
    law = TABLE["friction_law"].check("friction_law", friction_law)
    return 1.0 if is_table(law) else 0.5


def has_own_mu(contact: "Contact") -> bool:
    """Tell whether the structure's ``mu`` is not that of the contact: a table of its own has 1."""
    return contact.mu is not None or is_table(contact.friction_law)


def friction_of(contact: "Contact", common: Friction) -> Friction:
    """Friction of one contact: what it does not say itself is the structure's.

    Raises:
        ValueError: names the contact and the argument.
    """
    friction = _friction_of(contact, common)
    if contact.tangential_stiffness is not None and friction.friction_law != COULOMB:
        # a slider without mass has no motion of its own where friction falls with its speed: it
        # would jump
        raise ValueError(
            f"contact {contact.name}: friction_law = {brief(friction.friction_law)}: with a "
            "tangential_stiffness friction has one coefficient at all speeds; take coulomb, with a "
            "mu_static for a higher limit of stick, or leave the tangential_stiffness out"
        )
    return friction


def _friction_of(contact: "Contact", common: Friction) -> Friction:
    law = contact.friction_law
    mu, mu_static = contact.mu, contact.mu_static
    if mu is None and is_table(law):
        mu = 1.0
    if mu is None and law is not None and is_table(common.friction_law):
        raise ValueError(
            f"contact {contact.name}: friction_law = {law!r} needs a mu of its own, since the "
            "structure's mu is a factor of a table"
        )
    is_common = mu is None and law is None and mu_static is None
    law = common.friction_law if law is None else law
    try:
        return Friction(
            friction_law=law,
            mu=common.mu if mu is None else mu,
            mu_static=common.mu_static if is_common else mu_static,
            # the speeds of a table or of a law in Python are in m/s
            friction_speed=common.friction_speed if law in LAWS else 1.0,
        )
    except ValueError as error:
        raise ValueError(f"contact {contact.name}: {error}") from None
