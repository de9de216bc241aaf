"""Numbers of the regimes, switches, kinds of events and surfaces of contacts side by side.

They are those that the same contacts have as components of a traced system: regimes contact after
contact, switches within a contact by name, kinds in the order in which switches name them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from squealpipe.systems.belt_contact import SLIP, BeltContact
from squealpipe.systems.components import Composition, joined
from squealpipe.systems.linear.matrices import PIECE_FIELDS

CONTACT, REVERSAL, SEPARATION, SLIPS, SLIPS_BACK, KNOT = range(6)
"""Switches of a contact."""
PRESSING, LAG, MARGIN, MARGIN_BACK, BEFORE_END, AFTER_START = range(6)
"""Surfaces of a contact: normal force, |sliding speed|, what friction lacks to its limits, and how
far the speed is from the end and the start of its piece of a table."""
LANDS, STICKS, REVERSES, SEPARATES, SLIPS_AWAY, PASSES = range(6)
"""Kinds of events of a contact."""
KINDS = ("contact", "stick", "reversal", "separation", "slip", "knot")
IS_CLOSED, DIRECTION, IS_STUCK, FIRST_OF_PIECE = range(4)
"""Constants of a regime; those of a piece of a table follow."""


class ContactSwitch(NamedTuple):
    """One switch.

    Attributes:
        name: with the contact's.
        what: one of the switches of a contact, by number.
        contact: its contact.
        target: the regime that a knot leads to; −1 of others.
        leaves: regimes, by number.
        surface: of the contact.
        rises: whether it fires where its surface rises.
    """

    name: str
    what: int
    contact: int
    target: int
    leaves: tuple[int, ...]
    surface: int
    rises: bool


@dataclass(frozen=True, eq=False)
class Numbering:
    """What the engine reads of contacts, in the terms of a traced system.

    Args:
        names: of the contacts.
        n_modes: number of displacements.
        pieces: (pieces, 6) of a table of friction, or one row.
        shapes: number of further outputs.
    """

    names: Sequence[str]
    n_modes: int
    pieces: np.ndarray
    n_shapes: int = 0

    @cached_property
    def belt(self) -> BeltContact:
        """Regimes of one contact."""
        constants = [dict(zip(PIECE_FIELDS, row, strict=True)) for row in self.pieces]
        return BeltContact(
            frictions=constants if len(constants) > 1 else [{}],
            speed=lambda t, s, p, r: 0.0,
            unit=lambda p: 1.0,
        )

    @cached_property
    def width(self) -> int:
        """Number of constants of a contact's regime."""
        return FIRST_OF_PIECE + len(PIECE_FIELDS) * (len(self.pieces) > 1)

    @cached_property
    def regime_names(self) -> tuple[str, ...]:
        """Regimes of one contact."""
        return tuple(self.belt.regimes())

    @cached_property
    def row_of_constants(self) -> np.ndarray:
        """(regimes of a contact, constants)."""
        fields = ("contact", "direction", "stick", *PIECE_FIELDS)[: self.width]
        return np.array(
            [[row[key] for key in fields] for row in self.belt.regimes().values()]
        )

    @cached_property
    def regime_constants(self) -> dict[str, dict[str, float]]:
        """Regime → constants, of all contacts."""
        own = self.belt.regimes()
        return {
            joined(name, key): row for name in self.names for key, row in own.items()
        }

    @cached_property
    def composition(self) -> Composition:
        """Contacts as the components of a system."""
        each = len(self.regime_names)
        return Composition(
            names=tuple(self.names),
            regimes=dict(self.regime_constants),
            component_of=np.repeat(np.arange(len(self.names)), each),
            switches=(),
            starts=tuple([] for _ in self.names),
        )

    def regime(self, contact: int, name: str) -> int:
        """Number of a contact's regime."""
        return contact * len(self.regime_names) + self.regime_names.index(name)

    def _own_switches(self, contact: int) -> list[ContactSwitch]:
        name, belt = self.names[contact], self.belt

        def number(kind: str, piece: int = 0) -> int:
            return self.regime(contact, belt.name(kind, piece))

        def switch(
            own: str, what: int, leaves: list[int], surface: int, target: int = -1
        ) -> ContactSwitch:
            rises = what == CONTACT or surface == BEFORE_END
            where = tuple(leaves), surface, rises
            return ContactSwitch(joined(name, own), what, contact, target, *where)

        apart, stuck = number("separated"), number("stick")
        closed = [number(kind, piece) for kind, piece, _ in belt.in_contact()]
        # what falls for the leaving side rises for the side that is entered
        found = [
            switch("separation", SEPARATION, closed, PRESSING),
            switch("contact", CONTACT, [apart], PRESSING),
            switch("reversal", REVERSAL, [number(kind) for kind in SLIP], LAG),
            switch("slip", SLIPS, [stuck], MARGIN),
            switch("slip_back", SLIPS_BACK, [stuck], MARGIN_BACK),
        ]
        for kind in SLIP:
            for piece in range(len(belt.frictions) - 1):
                here, there = number(kind, piece), number(kind, piece + 1)
                names = belt.name(kind, piece), belt.name(kind, piece + 1)
                found += [
                    switch(
                        f"{names[0]} to {names[1]}", KNOT, [here], BEFORE_END, there
                    ),
                    switch(
                        f"{names[1]} to {names[0]}", KNOT, [there], AFTER_START, here
                    ),
                ]
        return sorted(found, key=lambda each: each.name)

    @cached_property
    def switches(self) -> tuple[ContactSwitch, ...]:
        """Switches by contact, within each by name."""
        places = range(len(self.names))
        return tuple(each for place in places for each in self._own_switches(place))

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of events, contact after contact."""
        own = KINDS if len(self.pieces) > 1 else KINDS[:-1]
        return tuple(joined(name, kind) for name in self.names for kind in own)

    @property
    def kinds_of_a_contact(self) -> int:
        """Number of kinds of one contact."""
        return len(self.kinds) // max(1, len(self.names))

    # in the terms of a traced system, of which what is counted alone matters here

    @property
    def size(self) -> int:
        """Number of states."""
        return 2 * self.n_modes

    @property
    def parameters(self) -> range:
        """Rows of numbers that a lane has before the constants of its regimes: see :mod:`.plan`."""
        return range(4 + 3 * len(self.names))

    @property
    def variables(self) -> range:
        """Places of the states."""
        return range(self.size)

    @property
    def surfaces_of_a_contact(self) -> int:
        """Number of surfaces of one contact."""
        return 6 if len(self.pieces) > 1 else 4

    @property
    def surfaces(self) -> range:
        """Places of the surfaces: those of one sort of all contacts side by side."""
        return range(self.surfaces_of_a_contact * len(self.names))

    @property
    def outputs(self) -> range:
        """Places of the outputs."""
        return range(2 * len(self.names) + self.n_shapes)

    @property
    def n_components(self) -> int:
        """Number of contacts."""
        return len(self.names)

    @cached_property
    def first_constant(self) -> np.ndarray:
        """(contacts + 1,) where the constants of each begin."""
        return self.width * np.arange(len(self.names) + 1)

    @cached_property
    def constants(self) -> range:
        """Places of the regimes' constants."""
        return range(self.width * len(self.names))

    @property
    def all_constants(self) -> range:
        """Likewise; nothing else is computed from them."""
        return self.constants

    @cached_property
    def component_of(self) -> np.ndarray:
        """(regimes,) the contact of each."""
        return np.asarray(self.composition.component_of)

    @cached_property
    def regimes(self) -> np.ndarray:
        """(regimes, constants) their values; 0 for those of other contacts."""
        return np.kron(np.eye(len(self.names)), self.row_of_constants)

    def columns(self, component: int) -> slice:
        """Places of the constants of a contact."""
        return slice(*self.first_constant[component : component + 2])

    def constants_in(self, regimes: Sequence[int]) -> np.ndarray:
        """All constants where each contact is in one of these regimes."""
        own = np.asarray(regimes) % len(self.regime_names)
        return np.asarray(self.row_of_constants[own].ravel())

    @cached_property
    def _watched(self) -> np.ndarray:
        table = np.full((2, len(self.component_of), len(self.surfaces)), -1, np.int64)
        for number, each in enumerate(self.switches):
            surface = each.surface * len(self.names) + each.contact
            table[int(each.rises), list(each.leaves), surface] = number
        return table

    @property
    def falls(self) -> np.ndarray:
        """(regime, surface) the switch that fires where it falls through zero, or −1."""
        return np.asarray(self._watched[0])

    @property
    def rises(self) -> np.ndarray:
        """(regime, surface) the switch that fires where it rises through zero, or −1."""
        return np.asarray(self._watched[1])

    @cached_property
    def owner(self) -> np.ndarray:
        """(surface,) its contact."""
        return np.tile(np.arange(len(self.names)), self.surfaces_of_a_contact)

    @cached_property
    def marks(self) -> np.ndarray:
        """(regime, surface) 0: no switch changes nothing."""
        return np.zeros(self.falls.shape, np.int64)

    @cached_property
    def clocks(self) -> np.ndarray:
        """(surface,) 0: none depends on the time alone."""
        return np.zeros(len(self.surfaces), np.int64)
