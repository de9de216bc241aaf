"""Make a piecewise-smooth system of a structure: one component a contact, with the regimes of A1.

Idea: q̈ is linear in q, v and the contact forces, so a structure is its matrices and, for each
contact, a regime: open, slipping either way, or stuck. A stuck contact adds a constraint on the
acceleration along its direction; contacts that stick together share one small system for their
friction forces.  The switches are those of the rigid pad of A1.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple, Self

import numpy as np

from squealpipe.laws import friction_laws
from squealpipe.laws.tables import is_table, pieces_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.dynamics import (
    Motion,
    Numbers,
    coefficients_of,
    law_in_use,
    reads_speed,
    total,
)
from squealpipe.structures.modes import modes_at_rest
from squealpipe.structures.reduction import conflict_in_stick
from squealpipe.systems.belt_contact import (
    DECIDES_FIRST,
    SLIP,
    BeltContact,
    Surface,
    negative,
)
from squealpipe.systems.components import MOST_COMPONENTS, Component, Switch
from squealpipe.systems.definition import SIZE_LIMITS
from squealpipe.systems.inputs.values import brief, is_finite_number, is_whole_number
from squealpipe.systems.linear.matrices import (
    COULOMB,
    EXPONENTIAL,
    HYPERBOLIC,
    PIECE_FIELDS,
    TABLE,
    Caps,
    ContactMatrices,
    diagonal_if_it_is,
)
from squealpipe.systems.linear.system import LinearSystem
from squealpipe.systems.system import System

STICK_ROUND_OFF = 1e-14
"""Force over a typical one: a contact sticks if friction lacks no more than this to hold it."""


def system(
    structure: ContactStructure, displacements: Mapping[str, Any] | None = None
) -> System:
    """The structure with contact loss, friction and stick as a :class:`squealpipe.System`.

    States are ``q1``…, ``v1``…: amplitudes of the modes of a reduced structure, else displacements.
    Parameters are ``mu``, ``belt_speed``, ``preload`` (a factor of all, and of the load that
    balances them) and what the friction law reads; ``<contact>_mu`` and ``<contact>_mu_static`` are
    those of a contact of its own. Each contact is a component with the regimes
    ``slip_slower``, ``slip_faster`` (than the belt), ``stick`` and ``separated``, in pieces where
    friction is a table; its outputs are ``<contact>_normal_force``, N, and ``<contact>_speed``,
    the speed of sliding, m/s.

    One compiled loop runs all structures (:mod:`squealpipe.systems.linear`). Where sticking
    contacts have dependent sliding directions their motion is unique, and of their friction forces
    those of the least norm are taken. Cycles, branches, curves, sensitivities and the horizon of
    predictability follow symbols, and so are limited to what :func:`component_system` can carry.

    Args:
        displacements: further outputs, m: name → a degree of freedom of the whole structure, or
            {degree of freedom: coefficient}, counted from 0.

    Raises:
        ValueError: too many degrees of freedom or contacts; transverse damping; a degree of freedom
            that does not exist.
    """
    if not structure.contacts or not is_in_loop(structure):
        return component_system(structure, displacements)
    _check_size(structure, Caps())
    equations = Equations(structure)
    scale = Scale.of(structure)
    shapes = {
        name: equations.shape(name, given)
        for name, given in (displacements or {}).items()
    }

    def matrices_at(speed: float) -> ContactMatrices:
        turning = structure.at_speed(speed)
        return matrices_of(turning, Numbers.of(turning), scale, [*shapes.values()])

    return LinearSystem(
        f"structure of {structure.size} degrees of freedom",
        states=_states(structure, scale),
        parameters=_parameters(structure),
        matrices=matrices_of(structure, equations.numbers, scale, [*shapes.values()]),
        contacts=[contact.name for contact in structure.contacts],
        coefficients=coefficient_names(structure),
        outputs=dict.fromkeys(shapes, "m"),
        time_scale=scale.time,
        general=lambda: component_system(structure, displacements),
        at_speed=matrices_at if structure.speed_terms.vary else None,
    )


def _check_size(structure: ContactStructure, caps: Caps) -> None:
    """Raise if a structure is larger than can be run, or has what runs cannot have."""
    size, count = structure.size, len(structure.contacts)
    damped = [
        contact.name for contact in structure.contacts if contact.transverse_damping
    ]
    if damped:
        raise ValueError(
            f"contact {damped[0]}: transverse_damping is a part of complex modes; in a run "
            "friction acts along the tangential direction alone: leave it out there"
        )
    if size > caps.modes:
        raise ValueError(
            f"{size} degrees of freedom: a system can have {caps.modes}; "
            + (
                "take structure.reduce().system()"
                if structure.modes is None
                else f"reduce the whole structure with n_modes={caps.modes}, and see the errors in "
                "its record"
            )
        )
    if count > caps.contacts:
        gigabytes = 8e-9 * (3 * 16 * count**2 + 12 * count**2)
        raise ValueError(
            f"{count} contacts: a system can have {caps.contacts}, and of so many a run would take "
            f"{gigabytes:.1f} GB; merge neighbours. Complex modes take any number"
        )


def component_system(
    structure: ContactStructure, displacements: Mapping[str, Any] | None = None
) -> System:
    """The same of components, whose functions are traced and compiled for this structure.

    Raises:
        ValueError: as :func:`system`; contacts that cannot all stick at once for their sliding
            directions are dependent.
    """
    size = structure.size
    _check_size(structure, Caps(SIZE_LIMITS.states // 2, MOST_COMPONENTS))
    if conflict := conflict_in_stick(structure):
        raise ValueError(conflict)
    equations = Equations(structure)
    scale = Scale.of(structure)
    states = _states(structure, scale)
    contacts = {
        contact.name: _Contact(equations, index, scale.force).component()
        for index, contact in enumerate(structure.contacts)
    }
    parts: dict[str, Any] = {"components": contacts}
    if not contacts:
        parts = {"regimes": {"free": {}}}
    return System(
        f"structure of {size} degrees of freedom",
        states=states,
        parameters=_parameters(structure),
        **parts,
        field=equations.field,
        start=dict.fromkeys(states, 0.0),
        outputs=equations.outputs(displacements or {}),
        time_scale=scale.time,
    )


def _states(structure: ContactStructure, scale: "Scale") -> dict[str, Any]:
    """Displacements, then velocities, with units and typical sizes."""
    unit = "m" if structure.modes is None else "kg^0.5 m"
    places = range(1, structure.size + 1)
    states: dict[str, Any] = {f"q{i}": (unit, scale.displacement) for i in places}
    return states | {f"v{i}": (f"{unit} s-1", scale.velocity) for i in places}


def matrices_of(
    structure: ContactStructure,
    numbers: Numbers,
    scale: "Scale",
    shapes: Sequence[np.ndarray],
) -> ContactMatrices:
    """Return the matrices that the loop of linear structures runs."""
    laws = [law_in_use(friction) for friction in structure.frictions]
    tables = [law for law in laws if is_table(law)]
    numbers_of_laws = {
        "coulomb": COULOMB,
        "exponential": EXPONENTIAL,
        "hyperbolic": HYPERBOLIC,
    }
    fields = [
        [piece[key] for key in PIECE_FIELDS]
        for piece in (pieces_of(tables[0]).constants("mu") if tables else [])
    ]
    return ContactMatrices(
        stiffness=diagonal_if_it_is(numbers.stiffness),
        damping=diagonal_if_it_is(numbers.damping),
        load=numbers.load,
        balanced=numbers.balanced,
        normals=numbers.normals,
        tangentials=numbers.tangentials,
        pushes=numbers.pushes,
        drags=numbers.drags,
        springs=structure.stiffnesses,
        preloads=structure.preloads,
        speeds=structure.speeds,
        laws=np.array([numbers_of_laws.get(law, TABLE) for law in laws], np.int64),
        pieces=np.array(fields or [[0.0] * len(PIECE_FIELDS)]),
        hidden=STICK_ROUND_OFF * scale.force,
        shapes=np.array(shapes).reshape(len(shapes), structure.size),
    )


def is_in_loop(structure: ContactStructure) -> bool:
    """Tell whether the loop of linear structures has the friction of all contacts.

    It has the laws of the package, and one table for all contacts; others are traced.
    """
    laws = {law_in_use(friction) for friction in structure.frictions}
    return laws <= set(friction_laws.LAWS) or (len(laws) == 1 and is_table(*laws))


def coefficient_names(structure: ContactStructure) -> list[tuple[str, str | None, Any]]:
    """Return for each contact the parameters of μ, of its static limit, and of its speed.

    The speed is a number where no parameter is.
    """
    found: list[tuple[str, str | None, Any]] = []
    for index, friction in enumerate(structure.frictions):
        names = [*coefficients_of(structure, index)]
        static = names[1] if len(names) > 1 else None
        fixed = friction.friction_speed
        found.append(
            (names[0], static, "friction_speed" if reads_speed(friction) else fixed)
        )
    return found


def _parameters(structure: ContactStructure) -> dict[str, float]:
    friction = structure.friction
    parameters = {"mu": friction.mu, "belt_speed": structure.belt_speed, "preload": 1.0}
    if friction.mu_static is not None:
        parameters["mu_static"] = friction.mu_static
    for place in range(len(structure.contacts)):
        parameters |= coefficients_of(structure, place)
    if any(map(reads_speed, (friction, *structure.frictions))):
        parameters["friction_speed"] = friction.friction_speed
    return parameters


class Equations:
    """The equations of motion of a structure, traced once for each state and regime."""

    def __init__(self, structure: ContactStructure) -> None:
        self.structure, self.numbers = structure, Numbers.of(structure)
        # functions of one contact are called with the constants of its regimes again and again
        self.at = lru_cache(maxsize=8)(self._at)

    def _at(self, s: Any, p: Any, r: Any) -> Motion:
        return Motion(self.structure, self.numbers, s, p, r)

    def field(self, t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:  # noqa: ARG002
        """Rates of all states."""
        rates = self.at(s, p, r).accelerations
        places = range(1, self.structure.size + 1)
        changes = {f"q{i}": getattr(s, f"v{i}") for i in places}
        return changes | {f"v{i}": rate for i, rate in zip(places, rates, strict=True)}

    def of_contact(self, what: str, place: int) -> Surface:
        """A quantity of one contact, by its name in :class:`Motion`."""
        return lambda t, s, p, r: getattr(self.at(s, p, r), what)[place]

    def outputs(self, displacements: Mapping[str, Any]) -> dict[str, Any]:
        """Normal force and sliding speed of each contact, and displacements."""
        outputs: dict[str, Any] = {}
        for index, contact in enumerate(self.structure.contacts):
            force = self.of_contact("normal_forces", index)
            speed = self.of_contact("sliding_speeds", index)
            outputs[f"{contact.name}_normal_force"] = ("N", force)
            outputs[f"{contact.name}_speed"] = ("m s-1", speed)
        for name, given in displacements.items():
            outputs[name] = ("m", _displacement(self.shape(name, given)))
        return outputs

    def shape(self, name: str, given: Any) -> np.ndarray:
        """Return a named displacement of the structure per unit of each state."""
        modes = self.structure.modes
        if modes is None:
            modes = np.eye(self.structure.size)
        chosen = given if isinstance(given, Mapping) else {given: 1.0}
        shape = np.zeros(modes.shape[1])
        for place, coefficient in chosen.items():
            if not is_whole_number(place) or not 0 <= place < len(modes):
                raise ValueError(
                    f"displacements: {name} = {brief(given)}: degrees of freedom are 0 to "
                    f"{len(modes) - 1}"
                )
            if not is_finite_number(coefficient):
                raise ValueError(
                    f"displacements: {name} = {brief(given)}: finite coefficients are needed"
                )
            shape += float(coefficient) * modes[int(place)]
        return shape


def _displacement(shape: np.ndarray) -> Surface:
    def displacement(t: Any, s: Any, p: Any, r: Any) -> Any:
        return total(shape, [getattr(s, f"q{i}") for i in range(1, len(shape) + 1)])

    return displacement


class Scale(NamedTuple):
    """Typical sizes of a structure's motion, for error control and default times."""

    time: float
    displacement: float
    velocity: float
    force: float

    @classmethod
    def of(cls, structure: ContactStructure) -> Self:
        """Return sizes by the preloads, or where there are none by the load, or by the belt."""
        omega, modes = modes_at_rest(structure)
        elastic = omega[omega > 1e-6 * omega.max()]
        mean = float(np.sqrt((elastic**2).mean())) if elastic.size else 1.0
        # amplitudes in which directions of contacts have a length
        reach = np.abs(structure.normals).max(axis=0, initial=0.0)
        pressed = np.abs(structure.preloads) / structure.stiffnesses
        displacement = float((pressed / reach).max(initial=0.0))
        if not displacement:
            amplitudes = modes.T @ structure.load
            static = amplitudes[omega > 0] / omega[omega > 0] ** 2
            displacement = float(np.abs(modes[:, omega > 0] @ static).max(initial=0.0))
        if not displacement:
            displacement = abs(structure.belt_speed) / mean or 1.0
        force = float(np.abs(structure.preloads).max(initial=0.0))
        stiffest = float(structure.stiffnesses.max(initial=0.0))
        lowest = float(elastic[0]) if elastic.size else 1.0
        return cls(
            1.0 / lowest,
            displacement,
            displacement * mean,
            force or stiffest * displacement,
        )


class _Contact:
    """Regimes and switches of one contact."""

    def __init__(self, equations: Equations, place: int, force: float) -> None:
        self.equations, self.place, self.force = equations, place, force
        structure = equations.structure
        friction, name = structure.frictions[place], structure.contacts[place].name
        pieces: list[dict[str, float]] = [{}]
        if is_table(friction.friction_law):
            pieces = pieces_of(friction.friction_law).constants("mu")
        self.pressing = equations.of_contact("pressing", place)
        self.speed = equations.of_contact("sliding_speeds", place)
        self.limit = equations.of_contact("limits", place)
        self.belt = BeltContact(
            frictions=pieces,
            speed=self.speed,
            unit=lambda p: friction.friction_speed,
            own=lambda r: getattr(r, name),
        )

    def component(self) -> Component:
        """The contact as a component of a system."""
        return Component(
            regimes=self.belt.regimes(),
            switches=[*self._switches(), *self.belt.friction_knots()],
            starts_in=self._starts(),
        )

    def _holding(self, t: Any, s: Any, p: Any, r: Any) -> Any:  # noqa: ARG002
        """The friction that would keep the contact on the belt."""
        return self.equations.at(s, p, r).holding(self.place)

    def _holds(self, t: Any, s: Any, p: Any, r: Any) -> Any:
        """Return whether friction can, ≥ 0, whatever its sign."""
        hidden = STICK_ROUND_OFF * self.force
        return self.limit(t, s, p, r) ** 2 + hidden**2 - self._holding(t, s, p, r) ** 2

    def _margin(self, sign: float) -> Surface:
        """Return the distance of the friction of stick from its limit, on one side."""
        friction = self.equations.of_contact("stick_friction", self.place)
        return lambda t, s, p, r: self.limit(t, s, p, r) - sign * friction(t, s, p, r)

    def _to_belt(self, t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        """Velocities with the contact on the belt, by an impulse of friction."""
        numbers = self.equations.numbers
        share = numbers.drags[:, self.place] / numbers.mobility[self.place, self.place]
        speed = self.speed(t, s, p, r)
        return {
            f"v{i}": getattr(s, f"v{i}") + float(part) * speed
            for i, part in enumerate(share, 1)
            if part
        }

    def _switches(self) -> Iterator[Switch]:
        closed = [self.belt.name(*each) for each in self.belt.in_contact()]
        yield Switch("separation", closed, self.pressing, "separated")
        # friction is 0 where contact begins and holds nothing: the contact slips
        landing = self.belt.landing("contact", self.speed)
        yield Switch("contact", "separated", negative(self.pressing), landing)
        ends = {
            "slip": (self._margin(1.0), "slip_slower"),
            "slip_back": (self._margin(-1.0), "slip_faster"),
        }
        yield from self.belt.belt_switches(self._holds, ends, self._to_belt)

    def _starts(self) -> list[Any]:
        """Return the regime in which a run starts: the first that fits.

        Where the contact is just closed, its velocity decides; on the belt the friction that
        would hold it.
        """
        slower, faster = map(self.belt.name, SLIP)
        normal = self.equations.numbers.normals[:, self.place]
        along = self.equations.numbers.tangentials[:, self.place]

        def rises(t: Any, s: Any, p: Any, r: Any) -> Any:
            motion = self.equations.at(s, p, r)
            lifts = total(normal, motion.velocities)
            return DECIDES_FIRST * lifts + total(normal, motion.accelerations)

        def on_belt(t: Any, s: Any, p: Any, r: Any) -> Any:
            return self.speed(t, s, p, r) / float(np.abs(along).max())

        def above(t: Any, s: Any, p: Any, r: Any) -> Any:
            return -DECIDES_FIRST * self.pressing(t, s, p, r) - self.force

        slips = self.belt.slips(self.speed)
        return [
            ("separated", rises, self.pressing),
            ("separated", above),
            ("stick", self._holds, on_belt),
            (slower, self._holding, on_belt),
            (faster, lambda t, s, p, r: -self._holding(t, s, p, r), on_belt),
            *slips[:-1],
            slips[-1][0],
        ]
