"""Components: regimes and switches that stand side by side in one system.

A system of n contacts with four regimes each has n components, not 4ⁿ regimes. Each component is
in one of its regimes at any time; names of what belongs to it begin with its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from squealpipe.systems.inputs.gate import Identifier, Number, Word, checked, needed
from squealpipe.systems.inputs.words import suggestion

Function = Callable[..., Any]
Target = str | tuple[str, Function | None] | tuple[str, Function | None, Word]
Targets = Annotated[
    str | Sequence[Target],
    needed("a regime, or a list of (regime, condition) and a regime, is"),
]
Begin = str | tuple[str, Function | None] | tuple[str, Function | None, Function | None]
Begins = Annotated[
    Sequence[Begin], needed("a list of (regime, condition, equality) and a regime is")
]
Regimes = Mapping[Word, Mapping[Identifier, Number]]
MOST_COMPONENTS = 16


@dataclass(frozen=True)
class Switch:
    """End of a regime of a component: a surface, a target and a reset.

    Attributes:
        name: of the event.
        leaves: the regime, or regimes, in which it can fire.
        when: surface (t, s, p, r); it fires where this falls through zero.
        to: the next regime, or a list of (regime, condition) or (regime, condition, kind) and a
            last regime (or (regime, None, kind)): the first whose condition is ≥ 0. ``kind``
            renames the event.
        reset: the states that jump, as a mapping from (t, s, p, r), or one such function for
            each regime entered: ``{"stick": …}``; in those left out no state jumps.

    ``when``, ``to`` and ``reset`` see the state before the reset and the constants ``r`` of the
    regime that is left. Regimes are those of the switch's own component.
    """

    name: Word
    leaves: Annotated[str | Sequence[str], needed("a regime, or a list of them, is")]
    when: Function
    to: Targets
    reset: Annotated[
        Function | Mapping[str, Function] | None,
        needed("a function, or one for each regime entered, is"),
    ] = None


Switch.__init__ = checked(Switch.__init__)  # type: ignore[method-assign]


@dataclass(frozen=True)
class Component:
    """Regimes beside those of other components, as a contact beside other contacts.

    Attributes:
        regimes: name → constants; functions read them as ``r.<component>.<constant>``.
        switches: between these regimes.
        starts_in: [(regime, condition) or (regime, condition, equality), …, regime], as of a
            :class:`squealpipe.System`.
    """

    regimes: Regimes
    switches: Sequence[Switch] = ()
    starts_in: Begins = ()


Component.__init__ = checked(Component.__init__)  # type: ignore[method-assign]


@dataclass(frozen=True)
class Composition:
    """Components side by side, their regimes and switches numbered throughout.

    Attributes:
        names: of the components; one without a name stands for a whole system.
        regimes: name → constants, those of the first component first; names begin with the
            component's.
        component_of: (regimes,) the component of each.
        switches: by component, within each by name.
        starts: ``starts_in`` of each component.
    """

    names: tuple[str, ...]
    regimes: dict[str, Mapping[str, float]]
    component_of: np.ndarray
    switches: tuple[Switch, ...]
    starts: tuple[list[Any], ...]

    @classmethod
    def of(cls, components: Mapping[str, Component]) -> Composition:
        """Join components; refuses names that are formed twice."""
        if not 1 <= len(components) <= MOST_COMPONENTS:
            raise ValueError(
                f"{len(components)} components; 1 to {MOST_COMPONENTS} can be carried"
            )
        regimes: dict[str, Mapping[str, float]] = {}
        switches: list[Switch] = []
        starts, places = [], []
        for index, (name, component) in enumerate(components.items()):
            for regime, constants in component.regimes.items():
                long = joined(name, regime)
                if long in regimes:
                    raise ValueError(
                        f"two components form the name {long!r}; rename a component or a regime"
                    )
                regimes[long] = constants
                places.append(index)
            known = list(component.regimes)
            switches += sorted(
                (_renamed(name, switch, known) for switch in component.switches),
                key=lambda each: each.name,
            )
            starts.append([_renamed_start(name, each) for each in component.starts_in])
        return cls(
            tuple(components),
            regimes,
            np.array(places, np.int64),
            tuple(switches),
            tuple(starts),
        )

    def regimes_of(self, component: int) -> np.ndarray:
        """Numbers of a component's regimes."""
        return np.flatnonzero(self.component_of == component)

    def numbers(self, chosen: Any) -> np.ndarray:
        """The regime of each component that a start names; −1 where it names none.

        Raises:
            ValueError: a regime or a component does not exist.
        """
        numbers_of = np.full(len(self.names), -1, np.int64)
        if chosen is None:
            return numbers_of
        if self.names == ("",):
            chosen = {"": chosen}
        elif not isinstance(chosen, Mapping):
            raise ValueError(
                f"start: regime {chosen!r}: {{component: regime}} is needed; components are "
                f"{', '.join(self.names)}"
            )
        for name, regime in chosen.items():
            if name not in self.names:
                raise ValueError(
                    f"start: component {name!r}: {suggestion(str(name), self.names)}"
                )
            place = self.names.index(name)
            known = [
                list(self.regimes)[i].removeprefix(joined(name, ""))
                for i in self.regimes_of(place)
            ]
            if regime not in known:
                raise ValueError(
                    f"start: regime {regime!r}: {suggestion(str(regime), known)}"
                )
            numbers_of[place] = list(self.regimes).index(joined(name, regime))
        return numbers_of

    def chosen(self, numbers: Sequence[int]) -> str | dict[str, str]:
        """Return the regimes of all components that a start names as ``regime``."""
        names = [list(self.regimes)[number] for number in numbers]
        if self.names == ("",):
            return names[0]
        return {
            component: name.removeprefix(joined(component, ""))
            for component, name in zip(self.names, names, strict=True)
        }


def joined(component: str, name: str) -> str:
    """A name of something of a component."""
    return f"{component}_{name}" if component else name


def _renamed(component: str, switch: Switch, known: Sequence[str]) -> Switch:
    """A switch with the long names of its regimes and kinds."""
    if not component:
        return switch
    leaves = [switch.leaves] if isinstance(switch.leaves, str) else switch.leaves
    targets = [switch.to] if isinstance(switch.to, str) else switch.to
    what = f"component {component!r}, switch {switch.name!r}"
    for regime in (*leaves, *(t if isinstance(t, str) else t[0] for t in targets)):
        if regime not in known:
            raise ValueError(
                f"{what}: regime {regime!r} is unknown; {suggestion(str(regime), known)}"
            )
    long: list[Any] = []
    for target in targets:
        regime, condition, kind = (
            (target, None, switch.name)
            if isinstance(target, str)
            else (*target, switch.name)[:3]
        )
        long.append((joined(component, regime), condition, joined(component, kind)))
    reset = switch.reset
    if isinstance(reset, Mapping):
        reset = {joined(component, name): each for name, each in reset.items()}
    return replace(
        switch,
        reset=reset,
        name=joined(component, switch.name),
        leaves=tuple(joined(component, regime) for regime in leaves),
        to=long,
    )


def _renamed_start(component: str, entry: Any) -> Any:
    if isinstance(entry, str):
        return joined(component, entry)
    return (joined(component, entry[0]), *entry[1:])
