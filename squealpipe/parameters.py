"""The physical parameters, their dimensionless groups, and the paper's named scenes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from numbers import Real
from typing import Any

_POSITIVE = ("mass", "k1", "k2", "k3", "preload", "length1", "length2", "sigma")
_UNITS = {
    "mass": "kg",
    "k1": "N m-1",
    "k2": "N m-1",
    "k3": "N m-1",
    "mu": "1",
    "belt_speed": "m s-1",
    "preload": "m",
    "length1": "m",
    "length2": "m",
    "sigma": "m-1",
}


def is_finite_number(value: object) -> bool:
    """Whether a value is a finite real number; truth values and text are not."""
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(float(value))


@dataclass(frozen=True, kw_only=True, repr=False)
class Parameters:
    """Physical parameters of the mass on two inclined springs above a belt.

    The defaults are the baseline inferred from the paper's own statements; the
    paper prints no numbers. Consistent units of any system work.

    Attributes:
        mass: m, kg.
        k1: stiffness of spring 1, N/m.
        k2: stiffness of spring 2, N/m.
        k3: contact stiffness, N/m.
        mu: Coulomb friction coefficient.
        belt_speed: V, m/s; its sign is the direction.
        preload: precompression l_pre of the contact spring, m.
        length1: free length of spring 1, m.
        length2: free length of spring 2, m.
        sigma: regularizing factor of tanh(sigma z), 1/m (paper, section 5).

    Raises:
        ValueError: names the field, its value and what is allowed.
    """

    mass: float = 1.0
    k1: float = 1.0
    k2: float = 1.0
    k3: float = 0.75
    mu: float = 0.3
    belt_speed: float = 100.0
    preload: float = 1.0
    length1: float = 5.0
    length2: float = 5.0
    sigma: float = 1e3

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not is_finite_number(value):
                raise ValueError(f"{item.name} = {value!r}: a finite number is needed")
            if item.name in _POSITIVE and not value > 0:
                raise ValueError(f"{item.name} = {value!r}: must be greater than 0")
            object.__setattr__(self, item.name, float(value))
        if self.mu < 0:
            raise ValueError(f"mu = {self.mu!r}: must be 0 or greater")

    def __repr__(self) -> str:
        """The call that makes it, and as a comment its dimensionless groups."""
        given = ", ".join(f"{name}={value!r}" for name, value in self.as_dict().items())
        return (
            f"Parameters({given})  # κ = {self.kappa:.4g}, μ = {self.mu:.4g}, "
            f"λ = {self.length_ratio:.4g}, v = {self.speed_ratio:.4g}"
        )

    @classmethod
    def from_groups(
        cls, *, kappa: float, mu: float, length_ratio: float, speed_ratio: float
    ) -> Parameters:
        """Equal springs with unit mass, stiffness and preload and the given groups."""
        return cls(
            k3=kappa, mu=mu, length1=length_ratio, length2=length_ratio, belt_speed=speed_ratio
        )

    @property
    def time_unit(self) -> float:
        """√(m/k1), s."""
        return math.sqrt(self.mass / self.k1)

    @property
    def belt_direction(self) -> float:
        """sgn V, with +1 for a belt at rest."""
        return 1.0 if self.belt_speed >= 0.0 else -1.0

    @property
    def drag(self) -> float:
        """μ sgn V: friction over normal force along +x on a mass that the belt drags along.

        The linear models and A4, which never slide faster than the belt, know V by this alone.
        """
        return self.belt_direction * self.mu

    @property
    def kappa(self) -> float:
        """κ = k3/k1."""
        return self.k3 / self.k1

    @property
    def length_ratio(self) -> float:
        """λ = L1/l_pre."""
        return self.length1 / self.preload

    @property
    def speed_ratio(self) -> float:
        """Belt speed v = V/(l_pre √(k1/m))."""
        return self.belt_speed * self.time_unit / self.preload

    def with_(self, **changes: float) -> Parameters:
        """A copy with some fields changed, validated again."""
        return replace(self, **changes)

    def as_dict(self) -> dict[str, float]:
        """Field name → value."""
        return asdict(self)

    @staticmethod
    def units(name: str) -> str:
        """CF unit of a field."""
        return _UNITS[name]


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One configuration of the paper: two angles, a horizon, and where it is shown.

    Attributes:
        name: key of the scene, for instance ``"F3"``.
        alpha1, alpha2: spring angles, rad.
        t_end: horizon, in units of √(m/k1).
        figure: figure of the paper that shows it.
        statement: what the paper says happens.
    """

    name: str
    alpha1: float
    alpha2: float
    t_end: float
    figure: int
    statement: str

    def __post_init__(self) -> None:
        checked = {"alpha1": self.alpha1, "alpha2": self.alpha2, "t_end": self.t_end}
        for key, value in checked.items():
            if not is_finite_number(value):
                raise ValueError(f"scene {self.name}: {key} = {value!r}: a finite number is needed")
        if not self.t_end > 0:
            raise ValueError(f"scene {self.name}: t_end = {self.t_end!r}: must be greater than 0")

    def __repr__(self) -> str:
        return (
            f"Scene({self.name}: alpha = ({self.alpha1 / math.pi:.6g}π, "
            f"{self.alpha2 / math.pi:.6g}π), t_end = {self.t_end:g}, Fig. {self.figure})"
        )


def _scene(
    name: str, over_pi: tuple[float, float], t_end: float, figure: int, statement: str
) -> Scene:
    return Scene(
        name=name,
        alpha1=over_pi[0] * math.pi,
        alpha2=over_pi[1] * math.pi,
        t_end=t_end,
        figure=figure,
        statement=statement,
    )


SCENES: dict[str, Scene] = {
    scene.name: scene
    for scene in (
        _scene("F2a", (0.5, 1.0), 50, 2, "contact is kept throughout"),
        _scene("F2b", (1.0, 0.5), 50, 2, "contact is kept throughout"),
        _scene("F2c", (0.75, 0.75), 50, 2, "contact is kept throughout"),
        _scene("F2d", (0.83, 0.83), 50, 2, "contact is lost"),
        _scene("F3", (0.4, 0.6), 500, 3, "the x oscillation grows without bound"),
        _scene("F4", (0.2, 0.8), 500, 4, "a bounded limit cycle"),
        _scene("F5a", (1.0, 1.0), 50, 5, "repeated jumps, identical to (0, 0)"),
        _scene("F5b", (0.0, 0.0), 50, 5, "repeated jumps, identical to (π, π)"),
        _scene("F10", (0.5, 1.0), 50, 10, "x alone near ω1; x and y near ω2"),
        _scene("F11", (1.0, 0.5), 50, 11, "nearly the same response as F10"),
        _scene("F12", (0.75, 0.75), 50, 12, "nearly the same response as F10"),
        _scene("F13", (5 / 6, 5 / 6), 50, 13, "contact is lost at the first mode"),
    )
}
"""The paper's named scenes (its figures 2–5 and 10–13)."""


def parameters_from(mapping: dict[str, Any]) -> Parameters:
    """``Parameters`` from a plain mapping, with unknown keys named.

    Raises:
        ValueError: an unknown key or a value that is not allowed.
    """
    known = {item.name for item in fields(Parameters)}
    unknown = sorted(set(mapping) - known)
    if unknown:
        raise ValueError(
            f"unknown parameter {', '.join(unknown)}; known: {', '.join(sorted(known))}"
        )
    return Parameters(**mapping)


def parameters_of(part: Mapping[str, Any]) -> Parameters:
    """``Parameters`` from a slice of the configuration that holds the section ``parameters``."""
    return Parameters(**part["parameters"])
