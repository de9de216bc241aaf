"""Records of what a user says about contacts of a mesh: a face that rubs, and a rotation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from squealpipe.parameters import TABLE, finite_number
from squealpipe.structures.contact import table_of_contact
from squealpipe.systems.inputs.values import brief, is_whole_number
from squealpipe.systems.inputs.words import says_what_was_meant
from squealpipe.validation import real_array

THE_BELT = "belt"
"""Word for a rigid belt in place of a surface."""


@says_what_was_meant
@dataclass(frozen=True, eq=False)
class Face:
    """A surface of a mesh that is pressed on another one, or on a rigid belt, and rubs there.

    Args:
        surface: name of the surface whose nodes become contacts: element faces, or a node set.
        against: name of the other surface; ``"belt"``: a rigid one.
        stiffness: of the whole face, N/m, shared among the nodes by their areas.
        stiffness_per_area: N/m³, in place of ``stiffness``.
        law: a table of the force of the whole face over its compression, in place of
            ``stiffness``, as of :class:`Contact`; its forces are shared by area.
        pressure: Pa.
        force: of the whole face, N, shared among the nodes by their areas; in place of
            ``pressure``.
        pressures: Pa, by node: {node: pressure}, or a file with a node and its pressure in each
            line; in place of ``pressure``.
        mu: its own coefficient of friction; None: the structure's.
        direction: direction in which ``against`` moves, three numbers; None: that of the rotation.
        points: number of contacts to which neighbours are merged; None: one for each node.
        tangential_stiffness: of the springs in series with friction of the whole face, N/m, shared
            among the nodes by their areas, as of :class:`Contact`; None: rigid.

    Raises:
        ValueError: names the argument, its value and what is needed.
    """

    surface: str
    against: str = THE_BELT
    stiffness: float | None = None
    stiffness_per_area: float | None = None
    pressure: float | None = None
    force: float | None = None
    pressures: Mapping[Any, float] | str | PathLike[str] | None = None
    mu: float | None = None
    direction: Sequence[float] | None = None
    points: int | None = None
    law: Any = None
    tangential_stiffness: float | None = None

    def __post_init__(self) -> None:
        for key in ("surface", "against"):
            object.__setattr__(self, key, _surface_name(key, getattr(self, key)))
        if self.surface == self.against:
            raise ValueError(
                f"against = {self.against!r}: a surface cannot rub against itself; name the other "
                f"one, or {THE_BELT}"
            )
        for key, units in {
            "stiffness": "N m-1",
            "tangential_stiffness": "N m-1",
            "stiffness_per_area": "N m-3",
            "pressure": "Pa",
            "force": "N",
        }.items():
            if (value := getattr(self, key)) is not None:
                object.__setattr__(self, key, _positive(key, value, units))
        if self.mu is not None:
            object.__setattr__(self, "mu", TABLE["mu"].check("mu", self.mu))
        if self.direction is not None:
            object.__setattr__(self, "direction", _vector("direction", self.direction))
        if self.points is not None and not (
            is_whole_number(self.points) and self.points > 0
        ):
            raise ValueError(
                f"points = {brief(self.points)}: a whole number from 1 on is needed"
            )
        if self.pressures is not None and not isinstance(
            self.pressures, Mapping | str | PathLike
        ):
            raise ValueError(
                f"pressures = {brief(self.pressures)}: {{node: pressure}} or the name of a file is "
                "needed"
            )
        object.__setattr__(self, "law", table_of_contact(self.law))
        self._one_of("stiffness", "stiffness_per_area", "law")
        self._one_of("pressure", "force", "pressures")

    def _one_of(self, *keys: str) -> None:
        given = [key for key in keys if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"{' and '.join(given)} are both given; leave one out"
                if given
                else f"{keys[0]} is missing; give it, or {' or '.join(keys[1:])}"
            )


def _surface_name(key: str, name: Any) -> str:
    if is_whole_number(name):  # Nastran's surfaces are numbers of properties
        return str(name)
    if not isinstance(name, str) or not name:
        raise ValueError(f"{key} = {brief(name)}: the name of a surface is needed")
    return name


def _positive(key: str, value: Any, units: str) -> float:
    number = finite_number(key, value, units)
    if not number > 0:
        nothing = ", or nothing presses the surfaces together"
        raise ValueError(
            f"{key} = {number:g}: must be greater than 0"
            + (nothing if key in ("pressure", "force") else "")
        )
    return number


@says_what_was_meant
@dataclass(frozen=True, eq=False)
class Rotation:
    """Rotation of one body of a mesh about an axis.

    A structure with one has a ``belt_speed`` in rad/s, and its contacts' ``speed`` is their radius
    in m.

    Args:
        axis: direction of the axis, three numbers; by the right-hand rule the body turns about it.
        through: a point on it, m.
        speed: Ω₀, rad/s, or a text like ``200 rpm``; a negative one turns the other way.
        body: name of a surface of the body that turns; None: what faces are ``against``.

    Raises:
        ValueError: names the argument, its value and what is needed.
    """

    axis: Any = (0.0, 0.0, 1.0)
    through: Any = (0.0, 0.0, 0.0)
    speed: float = 1.0
    body: str | None = None

    def __post_init__(self) -> None:
        axis = _vector("rotation: axis", self.axis)
        object.__setattr__(self, "axis", axis / np.linalg.norm(axis))
        through = _vector("rotation: through", self.through, zero=True)
        object.__setattr__(self, "through", through)
        speed = finite_number("rotation: speed", self.speed, "rad s-1")
        if speed == 0:
            raise ValueError(
                "rotation: speed = 0: nothing slides; give it in rad/s, or as a text like 200 rpm"
            )
        object.__setattr__(self, "speed", speed)
        if self.body is not None and not isinstance(self.body, str):
            raise ValueError(
                f"rotation: body = {brief(self.body)}: the name of a surface is needed"
            )

    def velocity(self, points: np.ndarray) -> np.ndarray:
        """Return the velocity of points, (…, 3), m, at 1 rad/s, in m/s: axis × (x − through)."""
        return np.cross(self.axis, points - self.through)

    def as_dict(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return {
            "axis": self.axis.tolist(),
            "through": self.through.tolist(),
            "speed": self.speed,
            "body": self.body,
        }


def _vector(name: str, given: Any, *, zero: bool = False) -> np.ndarray:
    vector = real_array(name, given)
    if vector.shape != (3,):
        raise ValueError(
            f"{name} = {brief(given)}: three numbers are needed, like [0, 0, 1]"
        )
    if not (zero or vector.any()):
        raise ValueError(
            f"{name} = {brief(given)} points nowhere: a direction is needed, like [0, 0, 1]"
        )
    return vector
