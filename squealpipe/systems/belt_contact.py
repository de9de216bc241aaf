"""The regimes of a contact with a moving belt, and the switches between them.

In contact it slips slower or faster than the belt, or sticks; a table of friction or of contact is
regimes whose knots are switches, so that forces are smooth in each.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from squealpipe.systems.components import Switch

Surface = Callable[[Any, Any, Any, Any], Any]
"""Function of time, states, parameters and regimes."""
SLIP = {"slip_slower": 1.0, "slip_faster": -1.0}
"""Regimes of slip by the sign of the sliding speed."""
DECIDES_FIRST = 1e150
"""Weight of what decides before anything else is asked."""


@dataclass(frozen=True, kw_only=True)
class BeltContact:
    """A contact by its laws.

    Attributes:
        frictions, presses: constants of the pieces of friction, by rising sliding speed, and of
            contact, by rising compression.
        sticks: whether friction can hold it.
        apart: regimes without contact.
        speed: of sliding, positive where the contact is slower than the belt.
        unit: of the speeds at the knots of friction, by the parameters.
        own: the contact's constants among those of all regimes.
    """

    frictions: Sequence[Mapping[str, float]]
    presses: Sequence[Mapping[str, float]] = ({},)
    sticks: bool = True
    apart: Sequence[str] = ("separated",)
    speed: Surface
    unit: Callable[[Any], Any]
    own: Callable[[Any], Any] = lambda r: r

    def name(self, kind: str, friction: int = 0, press: int = 0) -> str:
        """The name of a regime, with the numbers of its pieces where there are several."""
        if len(self.frictions) > 1 and kind in SLIP:
            kind += f"_{friction + 1}"
        return f"{kind}_press_{press + 1}" if len(self.presses) > 1 else kind

    def in_contact(self) -> Iterator[tuple[str, int, int]]:
        """Kind and pieces of each regime in contact."""
        for j in range(len(self.presses)):
            yield from (
                (kind, i, j) for i in range(len(self.frictions)) for kind in SLIP
            )
            if self.sticks:
                yield "stick", 0, j

    def regimes(self) -> dict[str, dict[str, float]]:
        """Regimes and their constants."""
        by_name = {}
        for kind, i, j in self.in_contact():
            terms = {"direction": SLIP.get(kind, 0.0), "stick": float(kind == "stick")}
            pieces = {**self.frictions[i], **self.presses[j]}
            by_name[self.name(kind, i, j)] = {"contact": 1.0, **terms, **pieces}
        terms = {"contact": 0.0, "direction": 0.0, "stick": 0.0}
        pieces = {**self.frictions[0], **self.presses[0]}
        return by_name | {name: {**terms, **pieces} for name in self.apart}

    def slips(self, speed: Surface) -> list[tuple[str, Surface]]:
        """Regimes of slip, the pieces of higher speeds first, and whether it slips so fast, ≥ 0."""

        def beyond(kind: str, i: int) -> Surface:
            def condition(t: Any, s: Any, p: Any, r: Any) -> Any:
                lag = SLIP[kind] * speed(t, s, p, r)
                return lag - self.frictions[i]["mu_start"] * self.unit(p) if i else lag

            return condition

        pieces = range(len(self.frictions))
        order = [(kind, i) for kind in SLIP for i in reversed(pieces)]
        return [(self.name(kind, i), beyond(kind, i)) for kind, i in order]

    def landing(
        self, kind: str, speed: Surface, stays: Surface | None = None
    ) -> list[Any]:
        """Return the targets of a switch by which contact begins: the regime depends on the sliding
        speed.

        Args:
            kind: of the event.
            stays: whether it sticks at once, ≥ 0.
        """
        targets: list[Any] = [(*slip, kind) for slip in self.slips(speed)]
        if stays is not None and self.sticks:
            targets = [(self.name("stick"), stays, kind), *targets]
        return [*targets[:-1], (targets[-1][0], None, kind)]

    def belt_switches(
        self,
        holds: Surface,
        ends: Mapping[str, tuple[Surface, str]],
        reset: Surface,
        press: int = 0,
    ) -> Iterator[Switch]:
        """Return the switches at which the contact reaches belt speed, and at which stick ends.

        Args:
            holds: whether friction can hold it there, ≥ 0.
            ends: of stick: name → what friction lacks to its limit, and the kind of slip.
            reset: of the state at belt speed.
            press: piece of contact.
        """
        tail = f"_{press + 1}" * (len(self.presses) > 1)
        slower, faster = (self.name(kind, 0, press) for kind in SLIP)
        stick = self.name("stick", 0, press)

        def direction(t: Any, s: Any, p: Any, r: Any) -> Any:
            return self.own(r).direction

        yield Switch(
            f"reversal{tail}",
            leaves=(slower, faster),
            when=lambda t, s, p, r: self.own(r).direction * self.speed(t, s, p, r),
            to=[
                *[(stick, holds, "stick")] * self.sticks,
                (faster, direction, "reversal"),
                (slower, None, "reversal"),
            ],
            reset=reset,
        )
        for name, (surface, kind) in ends.items() if self.sticks else ():
            target = self.name(kind, 0, press)
            yield Switch(f"{name}{tail}", stick, surface, [(target, None, "slip")])

    def friction_knots(self) -> Iterator[Switch]:
        """Return the switches at which a table of friction goes over from one piece to the next."""

        def past(end: str) -> Surface:
            def surface(t: Any, s: Any, p: Any, r: Any) -> Any:
                knot = getattr(self.own(r), f"mu_{end}") * self.unit(p)
                return self.own(r).direction * self.speed(t, s, p, r) - knot

            return surface

        for kind, i, j in self.in_contact():
            if kind in SLIP and i + 1 < len(self.frictions):
                here, there = self.name(kind, i, j), self.name(kind, i + 1, j)
                yield from knots(here, there, past)


def knots(here: str, there: str, past: Callable[[str], Surface]) -> Iterator[Switch]:
    """Return the switches at which a law goes over from one of its pieces to the next, and back.

    Args:
        past: how far what the law reads is beyond the end, or the start, of its piece.
    """
    yield Switch(
        f"{here} to {there}", here, negative(past("end")), [(there, None, "knot")]
    )
    yield Switch(f"{there} to {here}", there, past("start"), [(here, None, "knot")])


def negative(surface: Surface) -> Surface:
    """The surface seen from its other side."""
    return lambda t, s, p, r: -surface(t, s, p, r)
