"""Inputs that engineers know in place of parameters: a force, a ratio, stiffnesses.

Each is turned into the parameters that it stands for, in SI; these alone enter datasets and ids,
so a brake is the same run however it was written.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, NamedTuple

from squealpipe.laws import contact_laws
from squealpipe.systems.inputs.units import with_unit


class Substitute(NamedTuple):
    """An input that stands for parameters.

    Attributes:
        stands_for: parameters that must not be given beside it.
        needs: input that must be given beside it.
    """

    units: str
    stands_for: tuple[str, ...]
    meaning: str
    needs: str | None = None
    allowed: Literal["positive", "not negative"] = "positive"


SUBSTITUTES = {
    "preload_force": Substitute(
        "N", ("preload",), "force of the contact at rest, instead of preload"
    ),
    "pressure": Substitute(
        "Pa", ("preload",), "pressure on the area, instead of preload", "area"
    ),
    "area": Substitute(
        "m2", ("preload",), "area that the pressure acts on", "pressure"
    ),
    "damping_ratio": Substitute(
        "1",
        ("damping1", "damping2"),
        "ratio ζ of the dashpots of both springs, each c = 2 ζ √(k m) of its spring",
        allowed="not negative",
    ),
}
"""Inputs that are one number; ``stiffness`` has three: along the belt, across it, coupling."""


class Springs(NamedTuple):
    """Two equal springs: their stiffness, N/m, and angles, rad, from 0 to π."""

    k: float
    alpha1: float
    alpha2: float


def critical_damping(k: float, mass: float) -> float:
    """2 √(k m), N s/m: the dashpot of a damping ratio of 1 beside a spring of stiffness k."""
    return 2.0 * math.sqrt(k * mass)


def stands_for(name: str) -> tuple[str, ...]:
    """The parameters that an input stands for; none if it is a parameter itself."""
    if name == "stiffness":
        # stiffnesses along and across the belt stand for both springs, beside the angles
        return ("k1", "k2")
    return SUBSTITUTES[name].stands_for if name in SUBSTITUTES else ()


def rivals(name: str, names: Iterable[str]) -> list[str]:
    """The inputs among some that say what one says, in other words."""
    said = set(stands_for(name)) or {name}
    return [
        other
        for other in names
        if other != name
        and said.intersection(stands_for(other) or (other,))
        and not (name in SUBSTITUTES and SUBSTITUTES[name].needs == other)
    ]


def check_together(names: Sequence[str]) -> None:
    """Refuse inputs that say the same twice, or half of what is needed.

    Raises:
        ValueError: names both, and what to do.
    """
    for name in filter(stands_for, names):
        if others := rivals(name, names):
            raise ValueError(f"{name} stands for {others[0]}; keep one")
        needed = SUBSTITUTES[name].needs if name in SUBSTITUTES else None
        if needed is not None and needed not in names:
            raise ValueError(f"{name} needs {needed} beside it")


def stood_for(
    inputs: Mapping[str, Any], parameter: Callable[[str], Any]
) -> dict[str, float]:
    """Parameters in SI from the inputs that stand for them.

    Args:
        inputs: substitutes by name, in SI; ``stiffness`` is a mapping of its three
            names: along, across, coupling.
        parameter: the value of a parameter that is not stood for.

    Raises:
        ValueError: no parameters can be what is wanted.
    """
    values: dict[str, float] = {}
    if "stiffness" in inputs:
        k = equal_springs(**inputs["stiffness"]).k
        values |= {"k1": k, "k2": k}
    if "damping_ratio" in inputs:
        for spring in ("1", "2"):
            k = values.get(f"k{spring}") or parameter(f"k{spring}")
            critical = critical_damping(k, parameter("mass"))
            values[f"damping{spring}"] = inputs["damping_ratio"] * critical
    force = inputs.get("preload_force")
    if "pressure" in inputs:
        force = inputs["pressure"] * inputs["area"]
    if force is not None:
        law, k3 = parameter("contact_law"), parameter("k3")
        values["preload"] = contact_laws.preload_of(law, force, k3)
    return values


def equal_springs(along: float, across: float, coupling: float = 0.0) -> Springs:
    """Two equal springs with a stiffness matrix [[along, coupling], [coupling, across]].

    With θ1 = α1 and θ2 = π − α2 the directions of the springs from +x, K11 + K22 = 2k and
    (K11 − K22) + 2i K12 = 2k cos(θ1 − θ2) exp(i (θ1 + θ2)). Exchanging the springs gives the same
    matrix; the smaller α1 + α2 is taken, springs that do not cross.

    Raises:
        ValueError: the matrix is not positive definite, so that no springs have it.
    """
    determinant = along * across - coupling * coupling
    if not (along > 0 and across > 0 and determinant > 0):
        limit = math.sqrt(max(along, 0.0) * max(across, 0.0))
        raise ValueError(
            f"no two springs have the stiffness along {along:g}, across {across:g} and coupling "
            f"{coupling:g} N/m: along and across must be greater than 0, and the coupling below "
            f"√(along · across) = {limit:g} N/m"
        )
    difference, twice_coupling = along - across, 2.0 * coupling
    apart = math.atan2(
        2.0 * math.sqrt(determinant), math.hypot(difference, twice_coupling)
    )
    total = math.atan2(twice_coupling, difference)
    pairs = [
        (
            (total + sign * apart) / 2.0 % math.pi,
            -(total - sign * apart) / 2.0 % math.pi,
        )
        for sign in (1.0, -1.0)
    ]
    return Springs((along + across) / 2.0, *min(pairs, key=sum))


def became(inputs: Mapping[str, Any], parameter: Callable[[str], float]) -> list[str]:
    """Tell what each input became, like ``preload_force = 4 kN: preload = 0.5714 mm``.

    Args:
        inputs: substitutes by name, in SI.
        parameter: the value of each parameter, after :func:`stood_for`.
    """
    lines = []
    if "stiffness" in inputs:
        parts = [
            f"{name} {with_unit(value, 'N m-1')}"
            for name, value in inputs["stiffness"].items()
        ]
        springs = equal_springs(**inputs["stiffness"])
        first, second = map(math.degrees, springs[1:])
        lines.append(
            f"stiffness {', '.join(parts)}: k1 = k2 = {with_unit(springs.k, 'N m-1')} "
            f"at α1 = {first:.4g}° and α2 = {second:.4g}°"
        )
    if "damping_ratio" in inputs:
        first_dashpot, second_dashpot = (
            with_unit(parameter(name), "N s m-1") for name in ("damping1", "damping2")
        )
        lines.append(
            f"damping_ratio = {inputs['damping_ratio']:g}: damping1 = {first_dashpot} and "
            f"damping2 = {second_dashpot}, each 2 ζ √(k m) of its spring"
        )
    preload = f"preload = {with_unit(parameter('preload'), 'm')}"
    if "preload_force" in inputs:
        force = with_unit(inputs["preload_force"], "N")
        lines.append(f"preload_force = {force}: {preload}")
    if "pressure" in inputs:
        pressure, area = inputs["pressure"], inputs["area"]
        lines.append(
            f"pressure = {with_unit(pressure, 'Pa')} on {with_unit(area, 'm2')}: "
            f"preload_force = {with_unit(pressure * area, 'N')}, {preload}"
        )
    return lines
