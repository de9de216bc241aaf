"""A contact of a structure with the belt: where it acts, how stiff it is and what presses it on."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from squealpipe.laws.contact_laws import LINEAR, lines_of
from squealpipe.laws.tables import is_table, scaled
from squealpipe.parameters import TABLE, finite_number
from squealpipe.systems.inputs.units import refuse_units
from squealpipe.systems.inputs.values import brief, is_finite_number, is_whole_number
from squealpipe.systems.inputs.words import says_what_was_meant
from squealpipe.validation import real_array


def face_of(contact: str) -> str | None:
    """Return the face of a contact, ``lining`` of ``lining_12``; None if it has none."""
    match = re.fullmatch(r"(.+)_\d+", contact)
    return match[1] if match else None


class PointOrigin(NamedTuple):
    """Place in a mesh from which a contact comes.

    Attributes:
        nodes: numbers of the nodes that it acts on, of the face that rubs.
        against: numbers of the nodes of the other surface; none of a rigid belt.
        area: m².
        gap: distance along the normal, m, the largest of its nodes; negative where bodies overlap.
        position: of the middle of its forces, m.
        facet: longest edge of the facets that it meets where the gap is, m; NaN: not known.
    """

    nodes: tuple[int, ...]
    against: tuple[int, ...]
    area: float
    gap: float
    position: tuple[float, float, float]
    facet: float = float("nan")

    def as_dict(self) -> dict[str, Any]:
        """Return what a report says of it, as JSON takes it."""
        return {
            "nodes": list(self.nodes),
            "against": list(self.against),
            "area": self.area,
            "gap": self.gap,
        }


def table_of_contact(law: Any) -> str | None:
    """Return the text of a table of contact as it is stored; None where the law is linear.

    Raises:
        ValueError: another law, or a table that contacts of structures cannot have.
    """
    if law is None:
        return None
    law = TABLE["contact_law"].check("law", law)
    if is_table(law):
        try:
            lines_of(law)
        except ValueError as error:
            raise ValueError(f"law: {error}") from None
        return scaled(law, 1.0, 1.0)  # in one way, however it is written
    if law == LINEAR:
        return None
    raise ValueError(
        f"law = {law!r}: contacts of structures are linear or have a table (FILE.csv); a dashpot "
        "beside a contact is a part of damping"
    )


@says_what_was_meant
@dataclass(frozen=True, eq=False)
class Contact:
    """A point, or any combination of degrees of freedom, that is pressed on the belt.

    The normal force is N = preload − stiffness · nᵀq while that is positive, and acts along n;
    friction acts along t, towards the belt's motion.

    Args:
        name: for events and outputs.
        normal: n, {degree of freedom: coefficient}, counted from 0, or by its name ``"12.1"`` where
            the structure has names, or an array of all.
        tangential: t, likewise.
        stiffness: N/m, or a text like ``7 kN/mm``; greater than 0; None with a ``law``.
        preload: normal force where nᵀq = 0, N, or a text like ``0.2 kN``.
        speed: the belt's speed here over ``belt_speed``, as a radius; negative where the belt
            moves against t.
        mu: its own coefficient of friction, with a table a factor of it; None: the structure's.
        friction_law: a law of its own, as of the structure; None: the structure's. A table without
            a ``mu`` is taken as it is.
        mu_static: its own limit of stick. None: the structure's, or where the contact has a ``mu``
            or ``friction_law`` of its own, the coefficient at speed 0.
        across: the direction across t in the plane of sliding, for ``transverse_damping``.
        transverse_damping: whether complex modes include that friction turns with the sliding
            velocity, which damps small motions across it by μN/|V|. Runs in time, which have
            friction along t alone, refuse it.
        origin: where it comes from, of contacts of a mesh.
        law: a measured normal force over the compression δ, in place of ``stiffness``: a table,
            as ``contact_law`` of a pad, that is ``"FILE.csv"`` with the columns compression (m) and
            force (N), ``{"compression": [0, 1e-5, …], "force": [0, 90, …]}``, whose numbers may be
            texts with units, or ``"linear 0:0 1e-5:90 …"``. It begins with 0, 0 and rises; the
            slope of the last two points goes on. Where nᵀq = 0 the compression is that at which the
            force is the preload.
        tangential_stiffness: stiffness of a spring in series with friction (Jenkins' element), N/m,
            or a text with a unit: in stick the contact gives way elastically, and it slips once the
            force of the spring reaches the limit of friction. None: it sticks rigidly. With a
            spring, friction has one coefficient at all speeds, and may have a ``mu_static``.

    Raises:
        ValueError: names the contact and the argument.
    """

    name: str
    normal: Any
    tangential: Any
    stiffness: float | None = None
    preload: float = None  # type: ignore[assignment] # needed, but stiffness before it may be None
    speed: float = 1.0
    across: Any = None
    transverse_damping: bool = False
    mu: float | None = None
    friction_law: Any = None
    mu_static: float | None = None
    origin: PointOrigin | None = None
    law: Any = None
    tangential_stiffness: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise ValueError(
                f"contact {brief(self.name)}: letters, digits and _ are needed for a name"
            )
        self._check_law()
        self._check_numbers()
        self._check_friction_and_origin()
        for key in ("normal", "tangential", "across"):
            direction = getattr(self, key)
            if direction is None:
                continue
            each = (
                [*direction.values()] if isinstance(direction, Mapping) else direction
            )
            try:
                refuse_units(each)
            except ValueError as error:
                raise self._refusal(key, direction, str(error)) from None
        if not isinstance(self.transverse_damping, bool):
            raise self._refusal(
                "transverse_damping", self.transverse_damping, "True or False is needed"
            )
        if self.transverse_damping and self.across is None:
            raise self._refusal(
                "across",
                None,
                "transverse_damping needs the direction across, like across={2: 1.0}",
            )

    def _check_numbers(self) -> None:
        for key, units in (("stiffness", "N m-1"), ("preload", "N"), ("speed", "1")):
            if key == "stiffness" and self.law is not None:
                continue
            name = f"contact {self.name}: {key}"
            if getattr(self, key) is None:
                instead = ", or a law (a table)" if key == "stiffness" else ""
                raise ValueError(f"{name} is missing; give it{instead}")
            value = finite_number(name, getattr(self, key), units)
            object.__setattr__(self, key, value)
        if self.stiffness is not None and not self.stiffness > 0:
            raise self._refusal("stiffness", self.stiffness, "must be greater than 0")
        if (spring := self.tangential_stiffness) is not None:
            name = f"contact {self.name}: tangential_stiffness"
            spring = finite_number(name, spring, "N m-1")
            if not spring > 0:
                raise self._refusal(
                    "tangential_stiffness",
                    spring,
                    "must be greater than 0; leave it out for a contact that sticks rigidly",
                )
            object.__setattr__(self, "tangential_stiffness", spring)
        if self.speed == 0:
            raise self._refusal(
                "speed", self.speed, "the belt must move here; leave the contact out"
            )

    def _check_law(self) -> None:
        """Store the law as the text of a table, None where it is linear."""
        try:
            law = table_of_contact(self.law)
        except ValueError as error:
            raise ValueError(f"contact {self.name}: {error}") from None
        if law is not None and self.stiffness is not None:
            raise self._refusal(
                "stiffness", self.stiffness, "the law has one already; leave it out"
            )
        object.__setattr__(self, "law", law)

    @cached_property
    def lines(self) -> np.ndarray:
        """Pieces of the law: start and end, m, force at the start, N, and stiffness, (pieces, 4).

        Without a table it is one, from compression 0 on.
        """
        if self.law is None:
            return np.array([[0.0, 0.0, 0.0, self.stiffness]])
        return np.array(lines_of(self.law))

    @property
    def stiffness_at_preload(self) -> float:
        """Stiffness at the preload, N/m; of a table that of larger compressions at a point."""
        return float(self.lines[self._piece_of(self.preload), 3])

    @property
    def compression(self) -> float:
        """Compression at the preload, m; negative where the contact is open by that much."""
        force = self.preload
        start, _, low, stiffness = self.lines[self._piece_of(force)]
        return float(start + (force - low) / stiffness)

    def _piece_of(self, force: float) -> int:
        after = np.searchsorted(self.lines[:, 2], force, side="right")
        return max(int(after) - 1, 0)

    def force(self, nearing: Any) -> Any:
        """Return the normal force as if the contact could pull, N, at nᵀq = −nearing, m."""
        starts, _, forces, stiffnesses = self.lines.T
        compression = self.compression + nearing
        after = np.searchsorted(starts, compression, side="right")
        piece = np.maximum(after - 1, 0)
        return forces[piece] + stiffnesses[piece] * (compression - starts[piece])

    @property
    def energy_at_preload(self) -> float:
        """Energy that the preload stores in the contact, J."""
        force = self.preload
        if len(self.lines) == 1:
            return force**2 / (2.0 * float(self.lines[0, 3]))
        energy = 0.0
        for (start, _, low, stiffness), end in zip(
            self.lines, [*self.lines[1:, 0], np.inf], strict=True
        ):
            reached = min(end, self.compression) - start
            if reached > 0:
                energy += reached * (low + 0.5 * stiffness * reached)
        return float(energy)

    def scaled(self, *, stiffness: float = 1.0, preload: float = 1.0) -> Self:
        """Return the contact with stiffness and preload times factors.

        Stiffness is that of a linear contact, or the forces of a table, and that of a tangential
        spring: a lining of a softer material is softer in both directions.
        """
        spring = self.tangential_stiffness
        changes: dict[str, Any] = {
            "preload": preload * self.preload,
            "tangential_stiffness": spring and stiffness * spring,
        }
        if self.law is None:
            changes["stiffness"] = stiffness * float(self.stiffness or 0.0)
        elif stiffness != 1.0:
            changes["law"] = scaled(self.law, 1.0, 1.0 / stiffness)
        return replace(self, **changes)

    def _check_friction_and_origin(self) -> None:
        if self.origin is not None and not isinstance(self.origin, PointOrigin):
            raise self._refusal("origin", self.origin, "a PointOrigin is needed")
        for key in ("mu", "friction_law", "mu_static"):
            if (own := getattr(self, key)) is not None:
                try:
                    value = TABLE[key].check(key, own)
                except ValueError as error:
                    raise ValueError(f"contact {self.name}: {error}") from None
                object.__setattr__(self, key, value)

    def _refusal(self, key: str, value: object, why: str) -> ValueError:
        return ValueError(f"contact {self.name}: {key} = {brief(value)}: {why}")

    def direction(self, which: str, size: int) -> np.ndarray:
        """``normal`` or ``tangential`` over all degrees of freedom, (n,).

        Raises:
            ValueError: a degree of freedom that does not exist, or no direction at all.
        """
        given = getattr(self, which)
        if isinstance(given, Mapping):
            vector = np.zeros(size)
            for place, coefficient in given.items():
                if not is_whole_number(place) or not 0 <= place < size:
                    raise self._refusal(
                        which, place, f"degrees of freedom are 0 to {size - 1}"
                    )
                if not is_finite_number(coefficient):
                    raise self._refusal(which, coefficient, "a finite number is needed")
                vector[int(place)] = float(coefficient)
        else:
            vector = real_array(f"contact {self.name}: {which}", given)
            if vector.shape != (size,):
                raise self._refusal(
                    which,
                    given,
                    f"{size} finite numbers are needed, one a degree of freedom",
                )
        if not vector.any():
            raise self._refusal(which, given, "a coefficient other than 0 is needed")
        return vector


def by_rows(contact: Contact, names: Sequence[str] | None) -> Contact:
    """Return a contact whose directions name rows of the matrices by their numbers.

    Args:
        names: of the rows, ``node.direction``; None: they have none.

    Raises:
        ValueError: a name that no row has.
    """
    changed: dict[str, Any] = {}
    for which in ("normal", "tangential", "across"):
        given = getattr(contact, which)
        if not isinstance(given, Mapping):
            continue
        named = {place for place in given if isinstance(place, str)}
        if not named:
            continue
        row_of = {name: row for row, name in enumerate(names or ()) if name in named}
        if missing := named - row_of.keys():
            known = (
                f"where they are named like {names[0]}"
                if names
                else "which has no names; count rows from 0"
            )
            raise ValueError(
                f"contact {contact.name}: {which}: no degree of freedom {min(missing)!r} in the "
                f"structure, {known}"
            )
        changed[which] = {row_of.get(k, k): value for k, value in given.items()}
    return replace(contact, **changed) if changed else contact


def same_directions(before: Sequence[Contact], now: Sequence[Contact]) -> bool:
    """Tell whether contacts are the same but for numbers: their names, and where they act."""
    return len(before) == len(now) and all(
        one.name == other.name
        and one.transverse_damping == other.transverse_damping
        and all(
            getattr(one, which) is getattr(other, which)
            for which in ("normal", "tangential", "across")
        )
        for one, other in zip(before, now, strict=True)
    )


def directions(contacts: Sequence[Contact], size: int) -> tuple[np.ndarray, np.ndarray]:
    """All normals and all tangentials, (n, contacts) each.

    Raises:
        ValueError: a name twice, or a contact whose two directions are parallel.
    """
    names = [contact.name for contact in contacts]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"contacts: {name!r} is the name of two; rename one")
    normal, tangential = (
        np.array([contact.direction(which, size) for contact in contacts])
        .reshape(-1, size)
        .T
        for which in ("normal", "tangential")
    )
    for n, t, name in zip(normal.T, tangential.T, names, strict=True):
        if are_parallel(n, t):
            raise ValueError(f"contact {name}: normal and tangential are parallel")
    return normal, tangential


def are_parallel(one: np.ndarray, other: np.ndarray) -> bool:
    """Tell whether two directions are the same but for sign and length."""
    return _dependent(np.stack([one, other], axis=1)) is not None


def dependent_contacts(
    contacts: Sequence[Contact], tangentials: np.ndarray
) -> list[str]:
    """Name contacts whose sliding directions, (n, contacts), are linearly dependent.

    If they all stick at once, their friction forces cannot be told apart. Contacts with a
    tangential stiffness are not among them: the stretch of the spring gives the friction of each.
    """
    rigid = [contact.tangential_stiffness is None for contact in contacts]
    names = [contact.name for contact in contacts if not contact.tangential_stiffness]
    if (share := _dependent(tangentials[:, rigid])) is None:
        return []
    return [name for name, part in zip(names, share, strict=True) if abs(part) > 1e-6]


def transversals(
    contacts: Sequence[Contact], normals: np.ndarray, tangentials: np.ndarray
) -> np.ndarray:
    """Return the directions across sliding that are damped, 0 of other contacts, (n, contacts).

    Raises:
        ValueError: one lies in the plane of the normal and the tangential direction.
    """
    across = np.zeros_like(normals)
    for index, contact in enumerate(contacts):
        if not contact.transverse_damping:
            continue
        across[:, index] = contact.direction("across", len(normals))
        both = normals[:, index], tangentials[:, index]
        # a structure reduced to few modes cannot tell three directions apart
        if (
            len(normals) > 3
            and _dependent(np.stack([*both, across[:, index]], axis=1)) is not None
        ):
            raise ValueError(
                f"contact {contact.name}: across lies in the plane of normal and tangential; "
                "a third "
                "direction is needed"
            )
    return across


def _dependent(columns: np.ndarray) -> Any:
    """The combination of unit columns that vanishes, None if they are independent."""
    if not columns.size:
        return None
    lengths = np.linalg.norm(columns, axis=0)  # 0 in modes with a node at the contact
    # the triangle of QR has the same singular values and rows; a full decomposition of the long
    # columns of a large structure would have a square factor, as large as a dense matrix
    triangle = np.linalg.qr(columns / np.where(lengths > 0, lengths, 1.0), mode="r")
    _, sizes, rows = np.linalg.svd(triangle, full_matrices=True)
    # unit directions whose smallest singular value is below this depend on one another
    dependent = 1e-9
    if columns.shape[1] <= columns.shape[0] and sizes[-1] > dependent:
        return None
    return rows[-1]
