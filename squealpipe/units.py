"""Texts with a unit, like ``0.57 mm`` or ``7 kN/mm``, as numbers in SI.

pint knows the units. It is imported where the first such text is met: that takes a second, which
a study in plain numbers does not pay. Numbers are read and converted as decimals, so that
``0.57 mm`` is the double that ``5.7e-4`` is, and names the same run.
"""

import math
import operator
import re
from collections.abc import Mapping
from decimal import Decimal
from functools import lru_cache
from typing import Any

from squealpipe.text import RAISED, number

QUANTITIES = {
    "kg": ("a mass", "0.45 kg"),
    "m": ("a length", "0.57 mm"),
    "s": ("a time", "20 ms"),
    "N": ("a force", "4 kN"),
    "m s-1": ("a speed", "7.2 km/h"),
    "N m-1": ("a stiffness", "7 kN/mm"),
    "N s m-1": ("a damping constant", "42 N s/m"),
    "Pa": ("a pressure", "10 bar"),
    "m2": ("an area", "40 cm^2"),
    "m-1": ("an inverse length", "1000 1/m"),
    "rad": ("an angle", "22 deg"),
    "Hz": ("a frequency", "2 kHz"),
    "1": ("a number without a unit, or in %", "30 %"),
}
"""CF unit → what it measures, and an example of how people write it; others are read, too."""
SHOWN_IN: dict[str, tuple[tuple[float, str, float], ...]] = {
    "m": ((1.0, "m", 0.1), (1e3, "mm", 1e-4), (1e6, "µm", 0.0)),
    "s": ((1.0, "s", 1.0), (1e3, "ms", 0.0)),
    "N": ((1e-3, "kN", 1e3), (1.0, "N", 0.0)),
    "N m-1": ((1e-6, "kN/mm", 1e6), (1e-3, "N/mm", 1e4), (1.0, "N/m", 0.0)),
    "m s-1": ((1.0, "m/s", 0.1), (1e3, "mm/s", 0.0)),
    "Pa": ((1e-6, "MPa", 1e6), (1e-5, "bar", 1e4), (1.0, "Pa", 0.0)),
    "m2": ((1.0, "m²", 0.1), (1e4, "cm²", 0.0)),
    "Hz": ((1e-3, "kHz", 1e3), (1.0, "Hz", 0.0)),
}
"""CF unit → factor, unit as people write it, and the least value so written; largest first."""
PLAIN = ("percent", "permille", "ppm", "dimensionless")
"""Units of numbers without one; pint takes angles for such numbers too."""
TURNS = ("degree", "radian", "gradian", "turn", "arcminute", "arcsecond", "milliradian")
"""Units of angles, which pint takes for plain numbers."""
TURNING, CYCLES = (*TURNS, "revolution"), ("hertz",)
"""What names of units of angular frequencies hold, rpm among them, and of frequencies."""
SPELLINGS = (
    "newton_second = newton * second = Ns",
    "kilopond = kilogram_force = kp",
    "kilometer_in_an_hour = kilometer / hour = kmh",
)
"""Units as engineers write them that pint does not know."""

_ABROAD = (
    dict.fromkeys(("km/t", "km/tim", "km/std", "km/u", "км/ч"), "km/h")
    | {"m/sek": "m/s", "м/с": "m/s", "мм/с": "mm/s", "кН": "kN", "Н": "N"}
    | {"мкм": "µm", "мм": "mm", "м": "m"}
)
"""Units in other languages; to pint km/t is one of a kilometre and a ton."""
NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?"
_QUANTITY = re.compile(
    rf"({NUMBER})\s*((?:\b1\s*/\s*)?[^\d\s.,;:+#_-][^,;:#]*)", re.ASCII
)
_COMMA = re.compile(r"([+-]?\d*),(\d+)\s*(\D.*)?", re.ASCII)
_BEYOND_A_NUMBER = re.compile(rf"\s*(?!{NUMBER}\s*$)[-+−]?\.?\d", re.ASCII)
_POWER = re.compile(r"(?<=[^\W\d])(-?\d)")
_LONGEST = 60
"""Characters of the longest text that is read as a quantity."""


class UnitError(ValueError):
    """A text is no quantity of the kind that is needed; the message says what is."""


def has_unit(text: object) -> bool:
    """Whether something is a text of a number and something after it, as a unit is."""
    if not isinstance(text, str):
        return False
    try:
        float(text)  # 1e6: not the sixth power of an elementary charge
    except ValueError:
        return bool(_QUANTITY.fullmatch(_tidy(text)))
    return False


def is_unit(text: str) -> bool:
    """Whether pint knows a unit."""
    return _unit(text) is not None


def is_long_name(text: str) -> bool:
    """Whether a word is a unit in full, like point or rod, which may be no unit at all."""
    return str(_unit(text)) == text.lower()


def in_si(text: str, units: str, keys: Mapping[str, str] | None = None) -> float:
    """The number of a text with a unit, in SI.

    Args:
        units: CF unit of the result.
        keys: names and CF units of other inputs, to say which takes what was written.

    Raises:
        UnitError: it is no number with a unit, or one of another kind.
    """
    what, example = kind_and_example(units)
    tidy = _tidy(text)
    if match := _COMMA.fullmatch(tidy):
        raise UnitError(_without_comma(*match.groups("")))
    match = _QUANTITY.fullmatch(tidy)
    if match is None or len(tidy) > _LONGEST:
        raise UnitError(f"{what} is needed, like {example}")
    unit = _unit(match[2])
    if unit is None:
        raise UnitError(f"unknown unit {match[2]!r}; {what} is needed, like {example}")
    if _cf_unit(unit, [units]) is None:
        raise UnitError(_wrong_kind(unit, units, keys))
    quantity = _registry().Quantity(Decimal(match[1]), unit)
    return float(quantity.to(_pint_text(units)).magnitude)


def conversion(unit: str, other: str) -> float | None:
    """How many of another unit one unit is; None where they measure different things.

    An angular frequency is 2π times a frequency. A rate in 1/s, such as a growth rate, is neither.
    """
    pair = _unit(unit), _unit(other)
    if None in pair or pair[0].dimensionality != pair[1].dimensionality:
        return None
    factor = float(_registry().Quantity(Decimal(1), pair[0]).to(pair[1]).magnitude)
    turns, cycles = (
        [_names_any(each, words) for each in pair] for words in (TURNING, CYCLES)
    )
    if turns[0] == turns[1] and cycles[0] == cycles[1]:
        return factor
    if not all(map(operator.or_, turns, cycles)):
        return None
    return factor / math.tau if turns[0] else factor * math.tau


def _is_rotation(unit: Any) -> bool:
    per_second = _registry().parse_units("1/s").dimensionality
    return _names_any(unit, TURNING) and unit.dimensionality == per_second


def _names_any(unit: Any, words: tuple[str, ...]) -> bool:
    return any(word in str(unit) for word in words)


def number_of(value: Any, units: str, keys: Mapping[str, str] | None = None) -> Any:
    """A number in SI from a text with a unit or a quantity of pint; else the value as it is.

    Text that is a plain number, or does not begin with one, is left for the caller to refuse.
    """
    if isinstance(value, str):
        return in_si(value, units, keys) if _BEYOND_A_NUMBER.match(value) else value
    if hasattr(value, "magnitude") and hasattr(value, "dimensionality"):
        return in_si(f"{float(value.magnitude)!r} {value.units:D}", units, keys)
    return value


def shown_in(largest: float, units: str) -> tuple[float, str]:
    """Factor and unit in which people write values of a CF unit up to a largest one."""
    choices = SHOWN_IN.get(units, ()) if largest else ()  # 0 m/s, not 0 mm/s
    for factor, name, least in choices:
        if abs(largest) >= least:
            return factor, name
    return 1.0, plain_unit(units)


def plain_unit(units: str) -> str:
    """A CF unit as people write it: m/s, N s/m, rad/s."""
    if units == "1":
        return ""
    parts = re.findall(r"([A-Za-z]+)(-?\d+)?", units)
    above = " ".join(
        name + power.translate(RAISED)
        for name, power in parts
        if not power.startswith("-")
    )
    below = [
        name + ("" if power == "-1" else power[1:].translate(RAISED))
        for name, power in parts
        if power.startswith("-")
    ]
    return "/".join([above or "1", *below])


def kind_and_example(units: str) -> tuple[str, str]:
    """What a CF unit measures, and an example of how people write it."""
    plain = plain_unit(units)
    return QUANTITIES.get(units, (f"a value in {plain}", f"1 {plain}"))


def with_unit(value: float, units: str, digits: int = 4) -> str:
    """A value of a CF unit as people write it: 4 kN, 0.5714 mm."""
    factor, name = shown_in(value, units)
    return f"{value * factor:.{digits}g} {name}".rstrip()


def engineering(value: float, units: str, digits: int = 3) -> str:
    """The same for sentences and tables: 10 kN/mm, 829 Hz, 2.6·10⁻¹⁵ m."""
    factor, name = shown_in(value, units)
    return f"{number(value * factor, digits)} {name}".rstrip()


def _without_comma(head: str, tail: str, unit: str) -> str:
    """What to write instead of a number with a comma."""
    point = f"{head or 0}.{tail} {unit}".rstrip()
    if len(tail) != 3 or head.lstrip("+-") in {"", "0"}:  # separates no thousands
        return f"write a decimal point: {point}"
    whole = f"{head}{tail} {unit}".rstrip()
    return (
        f"the comma is a decimal point or separates thousands; write {point} or {whole}"
    )


def _tidy(text: str) -> str:
    """A text with the signs of typesetters replaced by those of a keyboard."""
    for sign, plain in (
        ("−", "-"),
        ("·", "*"),
        ("⋅", "*"),
        ("×", "*"),
        ("\u00a0", " "),
    ):
        text = text.replace(sign, plain)
    return text.strip()


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(non_int_type=Decimal)
    for words in SPELLINGS:
        registry.define(words)
    return registry


@lru_cache(maxsize=256)
def _unit(text: str) -> Any:
    """A unit of pint; None if it is none."""
    import tokenize

    from pint.errors import PintError

    # the tokenizer and evaluator below pint fail in their own ways on what is no expression
    failures = (PintError, ValueError, TypeError, AttributeError, AssertionError)
    try:
        text = _ABROAD.get(text, text)
        text = text.replace("U/min", "rpm")  # German; U is an enzyme's unit to pint
        return _registry().parse_units(_POWER.sub(r"**\1", text))  # m s-1, cm2
    except (*failures, ArithmeticError, SyntaxError, tokenize.TokenError, LookupError):
        return None


def _pint_text(units: str) -> str:
    """A CF unit as pint reads it."""
    factors = re.findall(r"([A-Za-z]+)(-?\d+)?", units)
    return "*".join(f"{name}**{power or 1}" for name, power in factors)


def _cf_unit(unit: Any, candidates: Any) -> str | None:
    """The first of some CF units that measures the same as a unit."""
    for units in candidates:
        if units in {"1", "rad"}:
            if str(unit) in (PLAIN if units == "1" else TURNS):
                return str(units)
        elif units == "Hz":  # not rad/s, nor a rate in 1/s
            if conversion(str(unit), units) and _names_any(unit, CYCLES):
                return str(units)
        elif (
            unit.dimensionality
            == _registry().parse_units(_pint_text(units)).dimensionality
        ):
            return str(units)
    return None


def _wrong_kind(unit: Any, units: str, keys: Mapping[str, str] | None) -> str:
    """What a unit measures, what is needed, and which inputs take what was written."""
    kind = _cf_unit(unit, QUANTITIES)
    is_kind = f"that is {QUANTITIES[kind][0]}" if kind else f"{unit} does not fit"
    if kind is None and _is_rotation(unit):
        becomes = (
            "in rad/s 2π times a frequency"
            if units == "Hz"
            else "a speed only when multiplied by the radius"
        )
        is_kind = f"that is a rate of rotation, {becomes}"
    takers = [name for name, units in (keys or {}).items() if kind and units == kind]
    elsewhere = (
        f"; {QUANTITIES[kind][0]} goes to {' or '.join(takers)}"
        if kind and takers
        else ""
    )
    what, example = kind_and_example(units)
    return f"{is_kind}; {what} is needed, like {example}{elsewhere}"
