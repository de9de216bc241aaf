"""Numbers of the regimes, switches, kinds of events and surfaces of contacts side by side.

They are those that the same contacts have as components of a traced system: regimes contact after
contact, switches within a contact by name, kinds in the order in which switches name them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from squealpipe.systems.belt_contact import SLIP, BeltContact
from squealpipe.systems.components import Composition, joined
from squealpipe.systems.linear.matrices import (
    FIRST_OF_PRESS,
    PIECE_FIELDS,
    PRESS_FIELDS,
    regime_constant,
)


class SwitchNumbers(NamedTuple):
    """Switches of a contact."""

    contact: int = 0
    reversal: int = 1
    separation: int = 2
    slips: int = 3
    slips_back: int = 4
    knot: int = 5


switch_number = SwitchNumbers()


class SurfaceNumbers(NamedTuple):
    """Surfaces of a contact.

    Attributes:
        pressing: normal force.
        lag: magnitude of the sliding speed.
        margin, margin_back: what friction lacks to its limits.
        before_end, after_start: distance of the speed from both ends of its piece of a table.
        press_end, press_start: distance of the normal force from those of its piece.
    """

    pressing: int = 0
    lag: int = 1
    margin: int = 2
    margin_back: int = 3
    before_end: int = 4
    after_start: int = 5
    press_end: int = 6
    press_start: int = 7


surface_number = SurfaceNumbers()

OF_CONTACT = 4
"""Numbers of each contact among the parameters of a run: μ, its static limit, the reference speed,
and the compression where nᵀq = 0, of a table of contact."""


class EventNumbers(NamedTuple):
    """Kinds of events of a contact."""

    lands: int = 0
    sticks: int = 1
    reverses: int = 2
    separates: int = 3
    slips_away: int = 4
    passes: int = 5


event_number = EventNumbers()

KINDS = ("contact", "stick", "reversal", "separation", "slip", "knot")


class Condition(NamedTuple):
    """Quantity that decides between the regimes a switch may enter; the condition holds if ≥ 0.

    Attributes:
        knot: sliding speed beyond which it slips in a piece of friction, over the reference; None:
            whether friction can hold the contact.
        direction: sign of this sliding speed; 0: of no condition that changes.
    """

    knot: float | None
    direction: float

    @property
    def varies(self) -> bool:
        """True if it depends on the state."""
        return self.knot is None or self.direction != 0.0


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
        targets: regimes that it may enter, the first whose condition holds, with the kind of the
            event; by number.
    """

    name: str
    what: int
    contact: int
    target: int
    leaves: tuple[int, ...]
    surface: int
    rises: bool
    targets: tuple[tuple[int, Condition | None, int], ...]


@dataclass(frozen=True, eq=False)
class Numbering:
    """Contacts as the engine reads them, in the terms of a traced system.

    Args:
        names: of the contacts.
        n_modes: number of displacements.
        pieces: (pieces, 6) of the table of friction of each contact, or one row.
        presses: (pieces, 4) of its table of contact, or one row.
        shapes: number of further outputs.
        sliders: contacts with a tangential spring, by number.
    """

    names: Sequence[str]
    n_modes: int
    pieces: Sequence[np.ndarray]
    presses: Sequence[np.ndarray]
    n_shapes: int = 0
    sliders: Sequence[int] = ()

    @cached_property
    def belts(self) -> list[BeltContact]:
        """Regimes of each contact."""

        def named(
            fields: Sequence[str], rows: np.ndarray
        ) -> Sequence[dict[str, float]]:
            if len(rows) == 1:
                return [{}]
            return [dict(zip(fields, row, strict=True)) for row in rows]

        return [
            BeltContact(
                frictions=named(PIECE_FIELDS, pieces),
                presses=named(PRESS_FIELDS, presses),
                speed=lambda t, s, p, r: 0.0,
                unit=lambda p: 1.0,
            )
            for pieces, presses in zip(self.pieces, self.presses, strict=True)
        ]

    @property
    def has_tables(self) -> bool:
        """True if the friction of some contact has several pieces."""
        return max(map(len, self.pieces)) > 1

    @property
    def has_presses(self) -> bool:
        """True if the force of some contact is a table of the compression."""
        return max(map(len, self.presses)) > 1

    @cached_property
    def width(self) -> int:
        """Number of constants of a contact's regime."""
        if self.has_presses:
            return FIRST_OF_PRESS + len(PRESS_FIELDS)
        return regime_constant.first_of_piece + len(PIECE_FIELDS) * self.has_tables

    @cached_property
    def regime_constants(self) -> dict[str, dict[str, float]]:
        """Regime → constants, of all contacts."""
        return {
            joined(name, key): row
            for name, belt in zip(self.names, self.belts, strict=True)
            for key, row in belt.regimes().items()
        }

    @cached_property
    def constants_of_regimes(self) -> np.ndarray:
        """(regimes, constants); of a contact without a table those of its pieces are 0."""
        every = ("contact", "direction", "stick", *PIECE_FIELDS, *PRESS_FIELDS)
        fields = every[: self.width]
        rows = self.regime_constants.values()
        return np.array([[row.get(key, 0.0) for key in fields] for row in rows])

    @cached_property
    def first_regime(self) -> np.ndarray:
        """(contacts + 1,) number of the first regime of each."""
        sizes = [len(belt.regimes()) for belt in self.belts]
        return np.concatenate([[0], np.cumsum(sizes)])

    @cached_property
    def composition(self) -> Composition:
        """Contacts as the components of a system."""
        return Composition(
            names=tuple(self.names),
            regimes=dict(self.regime_constants),
            component_of=np.repeat(
                np.arange(len(self.names)), np.diff(self.first_regime)
            ),
            switches=(),
            starts=tuple([] for _ in self.names),
        )

    def regime(self, contact: int, name: str) -> int:
        """Number of a contact's regime."""
        return int(self.first_regime[contact]) + self._places[contact][name]

    @cached_property
    def _places(self) -> list[dict[str, int]]:
        """Regime → its number among those of each contact."""
        return [
            {name: place for place, name in enumerate(belt.regimes())}
            for belt in self.belts
        ]

    def _own_switches(self, contact: int) -> list[ContactSwitch]:
        name, belt = self.names[contact], self.belts[contact]

        def number(kind: str, piece: int = 0, press: int = 0) -> int:
            return self.regime(contact, belt.name(kind, piece, press))

        def switch(
            own: str,
            what: int,
            leaves: list[int],
            surface: int,
            targets: list[tuple[int, Condition | None, int]],
        ) -> ContactSwitch:
            rises = what == switch_number.contact or surface in {
                surface_number.before_end,
                surface_number.press_end,
            }
            target = targets[0][0] if what == switch_number.knot else -1
            first = int(self.first_kind[contact])
            to = tuple((regime, each, first + kind) for regime, each, kind in targets)
            where = tuple(leaves), surface, rises, to
            return ContactSwitch(joined(name, own), what, contact, target, *where)

        apart = self.regime(contact, "separated")
        several = len(belt.presses) > 1
        # in the order of BeltContact.slips: the pieces of higher speeds first
        landings: list[tuple[int, Condition | None, int]] = [
            (
                number(kind, i),
                Condition(self.pieces[contact][i, 0] * (i > 0), side),
                event_number.lands,
            )
            for kind, side in SLIP.items()
            for i in reversed(range(len(belt.frictions)))
        ]
        # a slider takes the speed of the belt wherever its own speed vanishes, and may land with it
        is_slider = contact in self.sliders
        if is_slider:
            stays = number("stick"), Condition(None, 0.0), event_number.lands
            landings = [stays, *landings]
        closed = [number(*each) for each in belt.in_contact() if each[2] == 0]
        # what falls for the leaving side rises for the side that is entered
        found = [
            switch(
                "separation",
                switch_number.separation,
                closed,
                surface_number.pressing,
                [(apart, None, event_number.separates)],
            ),
            switch(
                "contact",
                switch_number.contact,
                [apart],
                surface_number.pressing,
                [*landings[:-1], (landings[-1][0], None, event_number.lands)],
            ),
        ]
        for press in range(len(belt.presses)):
            tail = f"_{press + 1}" * several
            stuck = number("stick", 0, press)
            slower, faster = (number(kind, 0, press) for kind in SLIP)
            reverses: list[tuple[int, Condition | None, int]] = [
                (stuck, Condition(None, 0.0), event_number.sticks),
                (faster, Condition(0.0, 0.0), event_number.reverses),
                (slower, None, event_number.reverses),
            ]
            if is_slider:
                reverses = [(stuck, None, event_number.sticks)]
            away = (
                [(slower, None, event_number.slips_away)],
                [(faster, None, event_number.slips_away)],
            )
            found += [
                switch(
                    f"reversal{tail}",
                    switch_number.reversal,
                    [slower, faster],
                    surface_number.lag,
                    reverses,
                ),
                switch(
                    f"slip{tail}",
                    switch_number.slips,
                    [stuck],
                    surface_number.margin,
                    [*away[0]],
                ),
                switch(
                    f"slip_back{tail}",
                    switch_number.slips_back,
                    [stuck],
                    surface_number.margin_back,
                    [*away[1]],
                ),
            ]
        for one, other, ends in self._neighbours(belt):
            ways = (one, other, ends[0]), (other, one, ends[1])
            found += [
                switch(
                    f"{belt.name(*left)} to {belt.name(*to)}",
                    switch_number.knot,
                    [number(*left)],
                    surface,
                    [(number(*to), None, event_number.passes)],
                )
                for left, to, surface in ways
            ]
        return sorted(found, key=lambda each: each.name)

    @staticmethod
    def _neighbours(
        belt: BeltContact,
    ) -> Iterator[tuple[tuple[str, int, int], tuple[str, int, int], tuple[int, int]]]:
        """Yield regimes in neighbouring pieces of a table, and the surfaces at their knot."""
        for kind, piece, press in belt.in_contact():
            if kind in SLIP and piece + 1 < len(belt.frictions):
                other = kind, piece + 1, press
                yield (
                    (kind, piece, press),
                    other,
                    (surface_number.before_end, surface_number.after_start),
                )
            if press + 1 < len(belt.presses):
                other = kind, piece, press + 1
                yield (
                    (kind, piece, press),
                    other,
                    (surface_number.press_end, surface_number.press_start),
                )

    @cached_property
    def switches(self) -> tuple[ContactSwitch, ...]:
        """Switches by contact, within each by name."""
        places = range(len(self.names))
        return tuple(each for place in places for each in self._own_switches(place))

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of events, contact after contact."""
        return tuple(
            joined(name, kind)
            for name, belt in zip(self.names, self.belts, strict=True)
            for kind in KINDS[: self._n_kinds(belt)]
        )

    @staticmethod
    def _n_kinds(belt: BeltContact) -> int:
        has_knots = len(belt.frictions) > 1 or len(belt.presses) > 1
        return len(KINDS) - (not has_knots)

    @cached_property
    def first_kind(self) -> np.ndarray:
        """(contacts + 1,) number of the first kind of event of each."""
        sizes = [self._n_kinds(belt) for belt in self.belts]
        return np.concatenate([[0], np.cumsum(sizes)])

    # in the terms of a traced system, of which what is counted alone matters here

    @property
    def size(self) -> int:
        """Number of states."""
        return 2 * self.n_modes + len(self.sliders)

    @property
    def parameters(self) -> range:
        """Rows of numbers that a lane has before the constants of its regimes: see :mod:`.plan`."""
        return range(4 + OF_CONTACT * len(self.names))

    @property
    def variables(self) -> range:
        """Places of the states."""
        return range(self.size)

    @property
    def surfaces_of_a_contact(self) -> int:
        """Number of surfaces of one contact."""
        if self.has_presses:
            return 8
        return 6 if self.has_tables else 4

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
        owners = np.eye(len(self.names))[self.component_of]
        found = owners[:, :, None] * self.constants_of_regimes[:, None]
        return np.asarray(found.reshape(len(found), -1))

    def columns(self, component: int) -> slice:
        """Places of the constants of a contact."""
        return slice(*self.first_constant[component : component + 2])

    def constants_in(self, regimes: Sequence[int]) -> np.ndarray:
        """All constants where each contact is in one of these regimes."""
        return np.asarray(self.constants_of_regimes[list(regimes)].ravel())

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
