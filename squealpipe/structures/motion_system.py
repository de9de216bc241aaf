"""Make a piecewise-smooth system of a structure: one component a contact, with the regimes of A1.

Idea: q̈ is linear in q, v and the contact forces, so a structure is its matrices and, for each
contact, a regime: open, slipping either way, or stuck. A stuck contact adds a constraint on the
acceleration along its direction; contacts that stick together share one small system for their
friction forces. The switches are those of the rigid pad of A1.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, Self

import numpy as np

from squealpipe.codes import Regime
from squealpipe.laws import friction_laws
from squealpipe.laws.tables import is_table, pieces_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.dynamics import (
    Numbers,
    coefficients_of,
    law_in_use,
    reads_speed,
)
from squealpipe.structures.modes import modes_at_rest
from squealpipe.systems.definition import SizeLimits
from squealpipe.systems.inputs.values import brief, is_finite_number, is_whole_number
from squealpipe.systems.linear.matrices import (
    PIECE_FIELDS,
    Caps,
    ContactMatrices,
    diagonal_if_it_is,
    friction_number,
)
from squealpipe.systems.linear.system import LinearSystem
from squealpipe.systems.system import System

LAW_NUMBERS = {
    "coulomb": friction_number.coulomb,
    "exponential": friction_number.exponential,
    "hyperbolic": friction_number.hyperbolic,
}
"""Friction laws that the loop of linear structures has beside tables."""


def system(
    structure: ContactStructure, displacements: Mapping[str, Any] | None = None
) -> System:
    """The structure with contact loss, friction and stick as a :class:`squealpipe.System`.

    States are ``q1``…, ``v1``…: amplitudes of the modes of a reduced structure, else displacements.
    Parameters are ``mu``, ``belt_speed``, ``preload`` (a factor of all, and of the load that
    balances them) and what the friction law reads; ``<contact>_mu`` and ``<contact>_mu_static`` are
    those of a contact of its own. Each contact is a component with the regimes
    ``slip_slower``, ``slip_faster`` (than the belt), ``stick`` and ``separated``, in pieces where
    friction or the normal force is a table; its outputs are ``<contact>_normal_force``, N, and
    ``<contact>_speed``, the speed of sliding, m/s.

    A contact with a tangential stiffness has a state more, ``<contact>_stretch``, m: friction over
    the stiffness of its spring. A spring is relaxed where no stretch is given, so that the contact
    starts in stick.

    One compiled loop runs all structures (:mod:`squealpipe.systems.linear`). Where sticking
    contacts have dependent sliding directions their motion is unique, and of their friction forces
    those of the least norm are taken.

    Args:
        displacements: further outputs, m: name → a degree of freedom of the whole structure, or
            {degree of freedom: coefficient}, counted from 0.

    Raises:
        ValueError: too many degrees of freedom or contacts; transverse damping; a degree of freedom
            that does not exist.
    """
    # what nothing touches is a system as any other, without a loop of its own
    free = Caps(modes=SizeLimits.states // 2)
    _check_size(structure, Caps() if structure.contacts else free)
    numbers, scale = Numbers.of(structure), Scale.of(structure)
    states = _states(structure, scale)
    shapes = {
        name: _shape(structure, name, given)
        for name, given in (displacements or {}).items()
    }
    title = f"structure of {structure.size} degrees of freedom"
    if not structure.contacts:
        return System(
            title,
            states=states,
            parameters=_parameters(structure),
            regimes={"free": {}},
            field=partial(_free_motion, numbers),
            start=dict.fromkeys(states, 0.0),
            outputs={
                name: ("m", partial(_combination, shape))
                for name, shape in shapes.items()
            },
            time_scale=scale.time,
        )
    matrices = matrices_of(structure, numbers, scale, [*shapes.values()])
    _check_tables(matrices)
    return LinearSystem(
        title,
        states=states,
        parameters=_parameters(structure),
        matrices=matrices,
        contacts=[contact.name for contact in structure.contacts],
        coefficients=coefficient_names(structure),
        outputs=dict.fromkeys(shapes, "m"),
        time_scale=scale.time,
    )


def _free_motion(numbers: Numbers, t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
    """Rates of all states where nothing touches."""
    places = range(1, len(numbers.load) + 1)
    changes = {f"q{i}": getattr(s, f"v{i}") for i in places}
    for i, load in zip(places, numbers.load, strict=True):
        pull = _combination(numbers.stiffness[i - 1], t, s, p, r)
        drag = _combination(numbers.damping[i - 1], t, s, p, r, "v")
        changes[f"v{i}"] = float(load) - pull - drag
    return changes


def _combination(
    shape: np.ndarray, t: Any, s: Any, p: Any, r: Any, what: str = "q"
) -> Any:
    """Σ c q, or Σ c v."""
    terms = ((float(c), f"{what}{i}") for i, c in enumerate(shape, 1) if c)
    return sum((c * getattr(s, name) for c, name in terms), 0.0 * s.q1)


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


def _check_tables(matrices: ContactMatrices) -> None:
    """Raise if tables have so many points that lists of their regimes do not fit into memory."""
    sizes = zip(matrices.pieces, matrices.presses, strict=True)
    regimes = sum(len(press) * (2 * len(slip) + 1) + 1 for slip, press in sizes)
    # of each regime 8 surfaces of each contact three times, and 13 constants
    gigabytes = 8e-9 * regimes * matrices.n_contacts * (3 * 8 + 13)
    if gigabytes > 4.0:
        raise ValueError(
            f"tables of {matrices.n_contacts} contacts have {regimes} regimes together, which "
            f"would take {gigabytes:.0f} GB in a run; leave points out of the tables"
        )


def _states(structure: ContactStructure, scale: "Scale") -> dict[str, Any]:
    """Displacements, velocities and stretches, with units and typical sizes."""
    unit = "m" if structure.modes is None else "kg^0.5 m"
    places = range(1, structure.size + 1)
    states: dict[str, Any] = {f"q{i}": (unit, scale.displacement) for i in places}
    states |= {f"v{i}": (f"{unit} s-1", scale.velocity) for i in places}
    return states | {
        f"{contact.name}_stretch": ("m", scale.force / contact.tangential_stiffness)
        for contact in structure.contacts
        if contact.tangential_stiffness is not None
    }


def matrices_of(
    structure: ContactStructure,
    numbers: Numbers,
    scale: "Scale",
    shapes: Sequence[np.ndarray],
) -> ContactMatrices:
    """Return the matrices that the loop of linear structures runs."""
    laws = _laws(structure)
    # Force over a typical one: a contact sticks if friction lacks no more than this to
    # hold it.
    stick_round_off = 1e-14
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
        laws=np.array(
            [LAW_NUMBERS.get(law, friction_number.table) for law in laws], np.int64
        ),
        pieces=[_pieces(law) for law in laws],
        presses=[contact.lines for contact in structure.contacts],
        hidden=stick_round_off * scale.force,
        shapes=np.array(shapes).reshape(len(shapes), structure.size),
        tangential_springs=structure.tangential_stiffnesses,
        by_speed=numbers.by_speed,
        reference=structure.speed_terms.reference,
        speed=structure.belt_speed,
    )


def _pieces(law: str) -> np.ndarray:
    """Return the pieces of a table of friction, (pieces, 6), or one row of zeros."""
    if not is_table(law):
        return np.zeros((1, len(PIECE_FIELDS)))
    rows = pieces_of(law).constants("mu")
    return np.array([[row[key] for key in PIECE_FIELDS] for row in rows])


def _laws(structure: ContactStructure) -> list[str]:
    """Return the friction law of each contact.

    Raises:
        ValueError: the loop of linear structures does not have it.
    """
    laws = [law_in_use(friction) for friction in structure.frictions]
    for law, contact in zip(laws, structure.contacts, strict=True):
        if law not in LAW_NUMBERS and not is_table(law):
            name = law if law in friction_laws.LAWS else "a law in Python"
            raise ValueError(
                f"contact {contact.name}: friction_law = {name}: runs of structures have "
                f"{', '.join(LAW_NUMBERS)} and tables; give its values over the sliding speed, "
                "friction_law={'speed': [0, …], 'coefficient': [0.5, …], 'between': 'cubic'} with "
                "mu=1, or as a table (friction_law='FILE.csv')"
            )
    return laws


def coefficient_names(structure: ContactStructure) -> list[tuple[str, str | None, Any]]:
    """Return for each contact the parameters of μ, of its static limit, and of its speed.

    The speed is a number where no parameter is.
    """
    coefficients: list[tuple[str, str | None, Any]] = []
    for index, friction in enumerate(structure.frictions):
        names = [*coefficients_of(structure, index)]
        static = names[1] if len(names) > 1 else None
        fixed = friction.friction_speed
        coefficients.append(
            (names[0], static, "friction_speed" if reads_speed(friction) else fixed)
        )
    return coefficients


def _parameters(structure: ContactStructure) -> dict[str, float]:
    friction = structure.friction
    parameters = {"mu": friction.mu, "belt_speed": structure.belt_speed, "preload": 1.0}
    if friction.mu_static is not None:
        parameters["mu_static"] = friction.mu_static
    for index in range(len(structure.contacts)):
        parameters |= coefficients_of(structure, index)
    if any(map(reads_speed, (friction, *structure.frictions))):
        parameters["friction_speed"] = friction.friction_speed
    return parameters


def _shape(structure: ContactStructure, name: str, given: Any) -> np.ndarray:
    """Return a named displacement of the structure per unit of each state."""
    modes = structure.modes
    if modes is None:
        modes = np.eye(structure.size)
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


def regime_codes(
    system: System, contacts: Sequence[str], belt: np.ndarray
) -> np.ndarray:
    """Return the code of ``Regime`` of each regime of a structure's system.

    The system counts slower and faster along the tangential direction of a contact, codes along
    the belt's own motion.

    Args:
        contacts: names, in the order of the components.
        belt: velocity of the belt along the tangential direction of each contact, (contacts,).
    """
    # of contacts c and c_2, regime c_2_stick is one of the latter; pieces of tables have numbers
    owners = np.asarray(system.traced.component_of)
    names = [
        name.removeprefix(f"{contacts[owner]}_")
        for name, owner in zip(system.regimes, owners, strict=True)
    ]
    codes = np.array(
        [next(code for code in Regime if name.startswith(code.name)) for name in names]
    )
    slower, faster = codes == Regime.slip_slower, codes == Regime.slip_faster
    against = np.asarray(belt)[owners] < 0.0
    codes[against & slower], codes[against & faster] = (
        Regime.slip_faster,
        Regime.slip_slower,
    )
    return codes
