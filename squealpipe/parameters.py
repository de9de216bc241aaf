"""The physical parameters, their dimensionless groups, and the paper's named scenes."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, Self

from squealpipe.laws import contact_laws, friction_laws
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, LAWS, coefficient, static_coefficient
from squealpipe.laws.tables import is_table, knots_of, named
from squealpipe.laws.tables import stood_for as stood_for_by_law
from squealpipe.substitutes import SUBSTITUTES, check_together, stands_for, stood_for
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.values import brief, is_finite_number, numbers_in_si
from squealpipe.systems.inputs.words import as_number, says_what_was_meant, suggestion

FULL_TURN = 2 * math.pi * (1 + 1e-9)
"""Largest angle, rad; beyond it one meant degrees, or slipped."""
BEYOND_A_TURN = "more than a full turn; angles are in rad, from −2π to 2π"
HORIZON = 200.0
"""Default horizon of maps and questions, in units of √(m/k1)."""


@dataclass(frozen=True)
class Row:
    """One parameter: units, symbol, meaning, allowed values. Everything else derives from it.

    Attributes:
        symbol: symbol as Typst mathematics.
        allowed: which values make sense; "law" is a name in ``laws``, or a file.
        enters_a1: it enters the integration of A1 and its variants.
        extension: it goes beyond the paper; at its default it is not written down, so that
            configurations and the ids of datasets stay what they were without it.
        optional: None is allowed too.
    """

    units: str
    symbol: str
    meaning: str
    allowed: Literal["finite", "positive", "not negative", "law"] = "positive"
    laws: Any = None
    enters_a1: bool = True
    extension: bool = False
    optional: bool = False

    def check(self, name: str, value: object) -> Any:
        """The value as it is stored."""
        if value is None and self.optional:
            return None
        if self.allowed == "law":
            try:
                law = named(value, self.laws.own_law_rules.columns)
                if isinstance(law, str) and self.laws.law_of(law) is not None:
                    return law
            except (ValueError, OSError) as error:
                raise ValueError(f"{name}: {error}") from error
            if why := self.laws.own_law_rules.refused.get(str(value)):
                raise ValueError(f"{name} = {value!r}: {why}")
            near = suggestion(value, self.laws.LAWS)
            raise ValueError(
                f"{name} = {brief(value)}: unknown; {near}, {self.laws.own_law_rules.files}"
            )
        number = finite_number(name, value, self.units, KEYS_THAT_TAKE)
        if self.allowed == "positive" and not number > 0:
            raise ValueError(f"{name} = {value!r}: must be greater than 0")
        if self.allowed == "not negative" and not number >= 0:
            raise ValueError(f"{name} = {value!r}: must be 0 or greater")
        return number


def finite_number(
    name: str, value: object, units: str, keys: Mapping[str, str] | None = None
) -> float:
    """A number in SI from a finite number, a text with a unit or a quantity of pint.

    Args:
        name: of the argument, for messages.
        units: CF unit of the result.
        keys: names and CF units of other inputs, to say which takes what was written.

    Raises:
        ValueError: it is none of these; names argument and value.
    """
    if type(value) is float and math.isfinite(value):
        return value  # copies of parameters are checked again, thousands of times in a search
    number = numbers_in_si(name, value, units, keys)
    if not is_finite_number(number):
        is_text = isinstance(value, str) and math.isfinite(as_number(value))
        remedy = f", not text: write {value} without quotation marks" if is_text else ""
        raise ValueError(f"{name} = {brief(value)}: a finite number is needed{remedy}")
    return float(number)


def direction_of(belt_speed: Any) -> Any:
    """sgn V of a number or of each entry of an array, with +1 for a belt at rest."""
    return 1.0 - 2.0 * (belt_speed < 0.0)


def law_in_words(law: str, units: tuple[str, str] = ("1", "1")) -> str:
    """The name of a law, the values of its table, or that it is a Python file.

    Args:
        units: CF units of the knots and values of a table, which are told in readable ones.
    """
    # a longer table is told by its first and last knots
    most_knots = 24
    if is_table(law):
        pairs = [
            f"{engineering(value, units[1], 4)} at {engineering(knot, units[0], 4)}"
            for knot, value in zip(*knots_of(law), strict=True)
        ]
        left_out = len(pairs) - most_knots
        if left_out > 0:
            pairs[most_knots // 2 : -(most_knots // 2)] = [f"… {left_out} more …"]
        return f"table, {law.split(maxsplit=1)[0]}: {', '.join(pairs)}"
    return law if law.isidentifier() else "Python file"


def _row(default: Any, units: str, symbol: str, meaning: str, **further: Any) -> Any:
    return field(
        default=default, metadata={"row": Row(units, symbol, meaning, **further)}
    )


@says_what_was_meant
@dataclass(frozen=True, kw_only=True, repr=False)
class Parameters:
    """Physical parameters of the mass on two inclined springs above a belt.

    The defaults are the baseline inferred from the paper's own statements; the
    paper prints no numbers. Consistent units of any system work.

    This class is the table of parameters, one row each. :data:`TABLE` has the rows.
    Units, configuration, sweeps, command line, integrators and the report's table derive from it.
    Dashpots and friction laws (``damping1`` to ``friction_speed``) extend the paper; see
    :mod:`squealpipe.laws` for the forces.

    Raises:
        ValueError: names the field, its value and what is allowed.
    """  # the attributes are added below, from the table

    mass: float = _row(1.0, "kg", "m", "mass of the particle")
    k1: float = _row(1.0, "N m-1", "k_1", "stiffness of spring 1")
    k2: float = _row(1.0, "N m-1", "k_2", "stiffness of spring 2")
    k3: float = _row(0.65, "N m-1", "k_3", "stiffness of the contact spring")
    mu: float = _row(
        0.3, "1", "mu", "sliding friction coefficient", allowed="not negative"
    )
    belt_speed: float = _row(
        100.0,
        "m s-1",
        "V",
        "speed of the belt, its sign the direction",
        allowed="finite",
    )
    preload: float = _row(1.0, "m", 'l_"pre"', "precompression of the contact spring")
    length1: float = _row(15.0, "m", "L_1", "free length of spring 1")
    length2: float = _row(15.0, "m", "L_2", "free length of spring 2")
    sigma: float = _row(
        1e3, "m-1", "sigma", "regularizing factor of the paper's tanh", enters_a1=False
    )
    damping1: float = _row(
        0.0,
        "N s m-1",
        "c_1",
        "dashpot along spring 1",
        allowed="not negative",
        extension=True,
    )
    damping2: float = _row(
        0.0,
        "N s m-1",
        "c_2",
        "dashpot along spring 2",
        allowed="not negative",
        extension=True,
    )
    friction_law: str = _row(
        COULOMB,
        "1",
        '"law"',
        f"friction law: {', '.join(LAWS)}, {friction_laws.own_law_rules.files}",
        allowed="law",
        laws=friction_laws,
        extension=True,
    )
    mu_static: float | None = _row(
        None,
        "1",
        "mu_s",
        "static friction coefficient, that of sliding if none is given",
        allowed="not negative",
        extension=True,
        optional=True,
    )
    friction_speed: float = _row(
        1.0,
        "m s-1",
        "v_0",
        "speed over which friction falls towards that of sliding",
        extension=True,
    )
    contact_law: str = _row(
        LINEAR,
        "1",
        '"contact"',
        f"contact law: {', '.join(contact_laws.LAWS)}, {contact_laws.own_law_rules.files}",
        allowed="law",
        laws=contact_laws,
        extension=True,
    )
    damping3: float = _row(
        0.0,
        "N s m-1",
        "c_3",
        "dashpot of the contact, of the contact law dashpot",
        allowed="not negative",
        extension=True,
    )

    def __post_init__(self) -> None:
        for name, row in TABLE.items():
            object.__setattr__(self, name, row.check(name, getattr(self, name)))
        if self.friction_speed < 1e-300:
            raise ValueError(
                f"friction_speed = {self.friction_speed!r}: must be 1e-300 or greater, for the "
                "laws divide by it"
            )
        follow = {}
        if is_table(self.friction_law):
            follow["mu"] = knots_of(self.friction_law)[1][-1]
        if is_table(self.contact_law):
            follow["k3"] = (
                contact_laws.preload_force(self.contact_law, self.preload)
                / self.preload
            )
            contact_laws.relative(self.contact_law, self.preload)
        for name in self.in_laws:
            given = getattr(self, name)
            if given not in (DEFAULTS[name], follow.get(name)):
                raise ValueError(
                    f"{name} = {given!r}: the file of a law stands for it; leave {name} out"
                )
        for name, value in follow.items():
            object.__setattr__(self, name, value)
        if self.damping3 and self.contact_law != "dashpot":
            raise ValueError(
                f"damping3 = {self.damping3!r}: contact_law = 'dashpot' alone reads it; give that "
                "law, or leave damping3 out"
            )
        onset = float(coefficient(0.0, self))
        if self.static_mu < onset * (1.0 - 1e-12):
            raise ValueError(
                f"mu_static = {self.mu_static!r}: it must be {onset!r}, the coefficient at speed "
                "0, or greater, for below that a mass at belt speed could neither stick nor slip"
            )

    def __repr__(self) -> str:
        """The call that makes it, and as a comment its dimensionless groups."""
        given = ", ".join(f"{name}={value!r}" for name, value in self.as_dict().items())
        return (
            f"Parameters({given})  # κ = {self.kappa:.4g}, μ = {self.mu:.4g}, "
            f"λ = {self.length_ratio:.4g}, v = {self.speed_ratio:.4g}"
        )

    @property
    def time_unit(self) -> float:
        """√(m/k1), s."""
        return math.sqrt(self.mass / self.k1)

    @property
    def fastest(self) -> float:
        """√((k1 + k2 + k3)/m), rad/s: linear frequencies and that of the whirl lie below it."""
        return math.sqrt((self.k1 + self.k2 + self.k3) / self.mass)

    @property
    def belt_direction(self) -> float:
        """sgn V, with +1 for a belt at rest."""
        return float(direction_of(self.belt_speed))

    @property
    def static_mu(self) -> float:
        """The static friction coefficient: ``mu_static``, where that is None that of sliding.

        Of a table, or a law of the user's own, the coefficient at speed 0.
        """
        return float(static_coefficient(self))

    @property
    def drag(self) -> float:
        """μ(|V|) sgn V: friction over normal force along +x on a mass that the belt drags along.

        The linear models and A4, which never slide faster than the belt, know V by this and, where
        μ depends on speed, by its slope.
        """
        return float(self.belt_direction * coefficient(abs(self.belt_speed), self))

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

    @property
    def in_laws(self) -> tuple[str, ...]:
        """Parameters that the file of a law stands for."""
        laws = {name: row.laws for name, row in TABLE.items() if row.laws}
        return tuple(
            each
            for name in laws
            for each in stood_for_by_law(getattr(self, name), laws[name])
        )

    @classmethod
    def of(cls, **inputs: Any) -> Self:
        """Parameters from what an engineer knows, in SI or as texts with a unit.

        Beside the fields it takes what stands for them: ``preload_force``, or ``pressure`` with
        ``area``, for ``preload``; ``damping_ratio`` ζ for both dashpots, each c = 2 ζ √(k m) of
        its spring; ``stiffness``, ``{"along": …, "across": …, "coupling": …}`` without the
        contact, for the two equal springs that have it
        (:func:`~squealpipe.substitutes.equal_springs` gives their angles).

        Raises:
            ValueError: names the input, its value and what is allowed.
        """
        check_together(list(inputs))
        others = {name: inputs.pop(name) for name in list(inputs) if stands_for(name)}
        for name in inputs.keys() - TABLE.keys():
            near = suggestion(name, [*TABLE, *SUBSTITUTES, "stiffness"])
            raise ValueError(f"{name}: no such parameter; {near}")

        def parameter(name: str) -> Any:
            return TABLE[name].check(name, inputs.get(name, DEFAULTS[name]))

        return cls(**(inputs | stood_for(read_substitutes(others), parameter)))

    @property
    def preload_force(self) -> float:
        """Force of the contact at rest, N."""
        if is_table(self.contact_law):
            return contact_laws.preload_force(self.contact_law, self.preload)
        return self.k3 * self.preload

    def with_(self, **changes: Any) -> Self:
        """A copy with some fields changed, validated again."""
        follow = {
            each: DEFAULTS[each]
            for name, row in TABLE.items()
            if row.laws
            for each in stood_for_by_law(
                row.check(name, changes.get(name, getattr(self, name))), row.laws
            )
        }
        return replace(self, **{**follow, **changes})

    def as_dict(self) -> dict[str, Any]:
        """Field name → value; extensions of the paper's model only where they differ from none."""
        return without_defaults({name: getattr(self, name) for name in TABLE})

    @staticmethod
    def units(name: str) -> str:
        """CF unit of a field."""
        return TABLE[name].units


TABLE: dict[str, Row] = {item.name: item.metadata["row"] for item in fields(Parameters)}
"""Name → row of each parameter, in order."""

UNITS_OF_INPUTS = {
    **{name: row.units for name, row in TABLE.items() if row.allowed != "law"},
    **{name: other.units for name, other in SUBSTITUTES.items()},
}
"""Name → CF unit of every input of a brake that is one number."""

KEYS_THAT_TAKE = UNITS_OF_INPUTS | {"alpha1": "rad", "alpha2": "rad", "t_end": "s"}
"""Units of these inputs, of both angles and of the horizon, for messages that name a key."""

PHYSICAL = tuple(name for name, row in TABLE.items() if row.enters_a1)
"""Parameters of a run of A1."""

NUMBERS_OF_A1: dict[str, str] = {
    "static_mu" if name == "mu_static" else name: name
    for name in PHYSICAL
    if TABLE[name].allowed != "law"
}
"""Name that laws and engine read → the parameter behind it, for all numbers that enter A1."""


def _by_symbol() -> dict[str, str]:
    """Symbol as it is typed, with and without its underscore → name of the parameter."""
    names: dict[str, str] = {}
    for name, row in TABLE.items():
        typed = re.sub(r"\W", "", row.symbol)
        for symbol in dict.fromkeys((typed, typed.replace("_", ""))):
            taken = symbol if symbol in TABLE else names.get(symbol, name)
            if taken != name:
                raise ValueError(
                    f"parameter {name}: its symbol {row.symbol!r} is typed {symbol}, which stands "
                    f"for {taken}; choose another symbol"
                )
            names[symbol] = name
    return names


SYMBOLS = _by_symbol()
"""The paper's symbols (``V``, ``L1``) for parameters that have another name here."""

DEFAULTS: dict[str, Any] = {item.name: item.default for item in fields(Parameters)}

Parameters.__doc__ = f"{Parameters.__doc__}\n    Attributes:\n" + "\n".join(
    f"        {name}: {row.meaning}{f', {row.units}' if row.units != '1' else ''}."
    for name, row in TABLE.items()
)


def read_substitutes(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs that stand for parameters, checked and in SI."""
    rows = {
        name: Row(other.units, "", other.meaning, allowed=other.allowed)
        for name, other in SUBSTITUTES.items()
    }
    part = Row("N m-1", "", "stiffness by directions", allowed="finite")
    values: dict[str, Any] = {}
    # stiffness along the belt, across it (without the contact), and the coupling of both, N/m
    of_stiffness = ("along", "across", "coupling")
    for name, value in inputs.items():
        if name != "stiffness":
            values[name] = rows[name].check(name, value)
            continue
        if not isinstance(value, Mapping) or not {"along", "across"} <= set(value) <= {
            *of_stiffness
        }:
            raise ValueError(
                f"stiffness = {brief(value)}: write {{along: …, across: …, coupling: …}}"
            )
        values[name] = {
            key: part.check(f"stiffness.{key}", value[key]) for key in value
        }
    return values


def without_defaults(values: Mapping[str, Any]) -> dict[str, Any]:
    """A mapping of parameters without the extensions that have their default value."""
    return {
        name: value
        for name, value in values.items()
        if not (name in TABLE and TABLE[name].extension and value == DEFAULTS[name])
    }


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
                raise ValueError(
                    f"scene {self.name}: {key} = {value!r}: a finite number is needed"
                )
            if key != "t_end" and abs(value) > FULL_TURN:
                raise ValueError(
                    f"scene {self.name}: {key} = {value!r}: {BEYOND_A_TURN}"
                )
        if not self.t_end > 0:
            raise ValueError(
                f"scene {self.name}: t_end = {self.t_end!r}: must be greater than 0"
            )

    @property
    def panel(self) -> str:
        """Figure and panel of the paper, like ``Fig. 2(a)``."""
        letter = self.name.lstrip("F0123456789")
        return f"Fig. {self.figure}({letter})" if letter else f"Fig. {self.figure}"

    def __repr__(self) -> str:
        return (
            f"Scene({self.name}: alpha = ({self.alpha1 / math.pi:.6g}π, "
            f"{self.alpha2 / math.pi:.6g}π), t_end = {self.t_end:g}, Fig. {self.figure})"
        )


SCENES: dict[str, Scene] = {
    name: Scene(
        name=name,
        alpha1=a * math.pi,
        alpha2=b * math.pi,
        t_end=t,
        figure=n,
        statement=says,
    )
    for name, a, b, t, n, says in (
        ("F2a", 0.5, 1.0, 50, 2, "contact is kept throughout"),
        ("F2b", 1.0, 0.5, 50, 2, "contact is kept throughout"),
        ("F2c", 0.75, 0.75, 50, 2, "contact is kept throughout"),
        ("F2d", 0.83, 0.83, 50, 2, "contact is lost"),
        ("F3", 0.4, 0.6, 500, 3, "the x oscillation grows without bound"),
        ("F4", 0.2, 0.8, 500, 4, "a bounded limit cycle"),
        ("F5a", 1.0, 1.0, 50, 5, "repeated jumps, identical to (0, 0)"),
        ("F5b", 0.0, 0.0, 50, 5, "repeated jumps, identical to (π, π)"),
        ("F10", 0.5, 1.0, 50, 10, "x alone near ω1; x and y near ω2"),
        ("F11", 1.0, 0.5, 50, 11, "nearly the same response as F10"),
        ("F12", 0.75, 0.75, 50, 12, "nearly the same response as F10"),
        ("F13", 5 / 6, 5 / 6, 50, 13, "contact is lost at the first mode"),
    )
}
"""The paper's named scenes (its figures 2–5 and 10–13)."""

SCENE_ANGLES = tuple(
    sorted(
        {angle for scene in SCENES.values() for angle in (scene.alpha1, scene.alpha2)}
    )
)
"""Every spring angle that a scene has, rad; π/2 among them."""


def parameters_of(part: Mapping[str, Any]) -> Parameters:
    """``Parameters`` from a slice of the configuration that holds the section ``parameters``."""
    return Parameters(**part["parameters"])
