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

from squealpipe.systems.inputs.words import RAISED, number

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
    "N m": ("a torque or an energy", "12 N m"),
    "1": ("a number without a unit, or in %", "30 %"),
}
"""CF unit → what it measures, and an example of how people write it; others are read, too."""
TURNS = (
    "degree",
    "radian",
    "gradian",
    "grade",
    "turn",
    "arcminute",
    "arcsecond",
    "milliradian",
)
"""Units of angles, which pint takes for plain numbers."""
TURNING, CYCLES = (*TURNS, "revolution"), ("hertz",)
"""Parts of the names of units of angular frequencies, rpm among them, and of frequencies."""
USUAL = (
    *(
        "g",
        "kg",
        "t",
        "µm",
        "mm",
        "cm",
        "m",
        "km",
        "ms",
        "s",
        "min",
        "h",
        "N",
        "kN",
        "Pa",
    ),
    *("kPa", "MPa", "GPa", "bar", "Hz", "kHz", "rad", "deg", "rpm", "newton", "meter"),
)
"""Units that a word in other capital and small letters stands for, like kN for KN."""

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?"
_QUANTITY = re.compile(
    rf"({NUMBER})\s*((?:\b1\s*/\s*)?[^\d\s.,;:+#_-][^,;:#]*)", re.ASCII
)
_BEYOND_A_NUMBER = re.compile(rf"\s*(?!{NUMBER}\s*$)[-+−]?\.?\d", re.ASCII)


class UnitError(ValueError):
    """A text is no quantity of the kind that is needed; the message says what is."""


def has_unit(text: object) -> bool:
    """Return whether a text is a number with something after it, as a unit is."""
    if not isinstance(text, str):
        return False
    try:
        float(text)  # 1e6: not the sixth power of an elementary charge
    except ValueError:
        return bool(_QUANTITY.fullmatch(_tidy(text)))
    return False


def is_unit(text: str) -> bool:
    """Return whether pint knows a unit."""
    return _unit(text) is not None


def is_long_name(text: str) -> bool:
    """Return whether a word is a unit in full, like point or rod, and so perhaps no unit at all."""
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
    _refuse_comma(tidy)
    match = _QUANTITY.fullmatch(tidy)
    # a longer text is a sentence, no quantity; pint would take seconds to refuse it
    if match is None or len(tidy) > 60:
        raise UnitError(f"{what} is needed, like {example}")
    return float(Decimal(match[1]) * _factor(match[2], units, keys))


def _factor(written: str, units: str, keys: Mapping[str, str] | None) -> Decimal:
    """Return the factor that converts a number from one unit to another.

    Raises:
        UnitError: the unit is unknown, ambiguous or of another kind.
    """
    what, example = kind_and_example(units)
    # pattern of a word that means two units → both of them, with a remedy
    ambiguous = {
        r"[kM]?tons?": "1000 kg or, in America, 907.18 kg; write t, or short_ton",
        r"[kM]?tons?_force|force_[kM]?tons?": (
            "9.807 kN or, in America, 8.896 kN; write tf, or 2000 lbf"
        ),
        "Mm": "a million metres; write mm, or km",
        "Ms": "a million seconds; write ms, or s",
        "gr": "a gram or a grain; write g, or grain",
        "mt": "a metric ton or a thousandth of one; write t, or kg",
        "cwt|hundredweight": "45.36 kg or, in Britain, 50.8 kg; write it in kg",
        "[gG]rad": "a degree or a 400th of a turn; write deg, or gon",
    }
    for word in re.findall(r"[^\W\d]+", written):
        for pattern, readings in ambiguous.items():
            if re.fullmatch(pattern, word):
                raise UnitError(f"{word} is {readings}")
    unit, target = _unit(written), _unit(units)
    if unit is None:
        near = _usual_letters(written)
        hint = f"; did you mean {near}?" if near else ""
        raise UnitError(
            f"unknown unit {written!r}{hint or f'; {what} is needed, like {example}'}"
        )
    if target is None:
        raise UnitError(
            f"the unit {units!r} of this number is unknown; give a plain number"
        )
    if not _measures(unit, units):
        raise UnitError(_wrong_kind(unit, units, keys))
    if not (_is_multiple(unit) and _is_multiple(target)):
        raise UnitError(
            f"{written.strip()} has a zero of its own or is logarithmic; convert it"
        )
    factor: Decimal = _registry().Quantity(Decimal(1), unit).to(target).magnitude
    return factor * Decimal(_turns_of(unit, target) or 1.0)


def _is_multiple(unit: Any) -> bool:
    """Tell whether twice the number is twice as much, which °C and decibels are not."""
    try:
        one, two = (
            float(_registry().Quantity(Decimal(n), unit).to_base_units().magnitude)
            for n in (1, 2)
        )
    except TypeError:  # logarithms of decimals
        return False
    return math.isclose(two, 2.0 * one)


def _usual_letters(written: str) -> str:
    """A unit in the usual capital and small letters, if it is known then and was not before."""
    usual = {unit.lower(): unit for unit in USUAL}
    near = re.sub(
        r"[^\W\d]+", lambda word: usual.get(word[0].lower(), word[0]), written
    )
    return near if near != written and is_unit(near) else ""


def conversion(unit: str, other: str) -> float | None:
    """Return how many of another unit one unit is, or None where they measure different things.

    An angular frequency is 2π times a frequency. A rate in 1/s, such as a growth rate, is neither.
    """
    pair = _unit(unit), _unit(other)
    if None in pair or pair[0].dimensionality != pair[1].dimensionality:
        return None
    turns = _turns_of(*pair)
    if turns is None:
        return None
    return (
        float(_registry().Quantity(Decimal(1), pair[0]).to(pair[1]).magnitude) * turns
    )


def _turns_of(unit: Any, other: Any) -> float | None:
    """2π from a frequency to an angular one, or its inverse; 1 of other units of one kind.

    pint takes all of them, and rates in 1/s, for the same.
    """
    pair = unit, other
    turns, cycles = (
        [_names_any(each, words) for each in pair] for words in (TURNING, CYCLES)
    )
    if turns[0] == turns[1] and cycles[0] == cycles[1]:
        return 1.0
    if not all(map(operator.or_, turns, cycles)):
        return None
    return 1.0 / math.tau if turns[0] else math.tau


def _is_rotation(unit: Any) -> bool:
    per_second = _registry().parse_units("1/s").dimensionality
    return _names_any(unit, TURNING) and unit.dimensionality == per_second


def _names_any(unit: Any, words: tuple[str, ...]) -> bool:
    return any(word in str(unit) for word in words)


def number_of(value: Any, units: str, keys: Mapping[str, str] | None = None) -> Any:
    """A number in SI from a text with a unit or a quantity of pint; else the value as it is.

    Text that is a plain number, or does not begin with one, is left for the caller to refuse.
    Arrays and lists, of quantities too, become arrays and lists of numbers. So do arrays of xarray
    that state another unit of the same kind; what states one of another kind is left.

    Args:
        units: CF unit of the result, or any that pint knows.

    Raises:
        UnitError: the unit is unknown, ambiguous or of another kind; another library's quantity.
    """
    if isinstance(value, str):
        return in_si(value, units, keys) if _BEYOND_A_NUMBER.match(value) else value
    if is_quantity(value):
        return _scaled(value.magnitude, _factor(f"{value.units:D}", units, keys))
    stated = getattr(value, "attrs", {}).get("units", units)
    if stated != units and conversion(str(stated), units) is not None:
        return _scaled(value.values, _factor(str(stated), units, keys))
    if holds_units(value):
        if not isinstance(value, list | tuple):
            raise UnitError(
                "a quantity of another library than pint, or an array of quantities; write a text "
                "with its unit, like '2 mm', or a plain number"
            )
        return [number_of(each, units, keys) for each in value]
    return value


def holds_units(value: Any) -> bool:
    """Tell whether a value is a quantity or a text with a unit, or a list or array with one."""
    if isinstance(value, str):
        return _BEYOND_A_NUMBER.match(value) is not None
    if isinstance(value, list | tuple):
        return any(map(holds_units, value))
    if getattr(getattr(value, "dtype", None), "kind", "") == "O":
        return any(map(holds_units, getattr(value, "flat", ())))
    of_others = hasattr(value, "value") and (
        hasattr(value, "unit") or hasattr(value, "units")
    )
    in_array = is_quantity(getattr(value, "data", None))  # of xarray
    return is_quantity(value) or in_array or of_others


def refuse_units(value: Any) -> None:
    """Raise if a value that has no declared unit has one."""
    if holds_units(value):
        for each in value if isinstance(value, list | tuple) else ():
            refuse_units(each)
        if isinstance(value, str):
            _refuse_comma(_tidy(value))
        raise UnitError("a plain number is needed: no unit is declared for it")


def is_quantity(value: Any) -> bool:
    """Tell whether a value is a quantity of pint."""
    return hasattr(value, "magnitude") and hasattr(value, "dimensionality")


def _scaled(magnitude: Any, factor: Decimal) -> Any:
    """Numbers, or a dense or sparse array of them, times a factor, each rounded once."""
    import numpy as np

    def one(number: Any) -> float:
        try:
            plain = number if isinstance(number, int | Decimal) else repr(float(number))
            return float(Decimal(plain) * factor)
        except (
            ArithmeticError,
            TypeError,
            ValueError,
        ):  # as Decimal reports what it cannot read
            raise UnitError(f"{number} is no real number") from None

    if hasattr(magnitude, "tocoo"):
        scaled = magnitude.tocoo(copy=True).astype(float)
        scaled.data = np.array([one(each) for each in magnitude.tocoo().data.tolist()])
        return scaled.asformat(magnitude.format)
    if np.iscomplexobj(magnitude) or np.ma.is_masked(magnitude):
        raise UnitError("real numbers are needed, none of them masked")
    array = np.asarray(magnitude)
    if not array.ndim:
        return one(array.item())
    return np.array([one(each) for each in array.ravel().tolist()]).reshape(array.shape)


def shown_in(largest: float, units: str) -> tuple[float, str]:
    """Factor and unit in which people write values of a CF unit up to a largest one."""
    # for each CF unit: factor, unit as people write it, and the least value so written; largest
    # first
    scales: dict[str, tuple[tuple[float, str, float], ...]] = {
        "m": ((1.0, "m", 0.1), (1e3, "mm", 1e-4), (1e6, "µm", 0.0)),
        "s": ((1.0, "s", 1.0), (1e3, "ms", 0.0)),
        "N": ((1e-3, "kN", 1e3), (1.0, "N", 0.0)),
        "N m-1": ((1e-6, "kN/mm", 1e6), (1e-3, "N/mm", 1e4), (1.0, "N/m", 0.0)),
        "m s-1": ((1.0, "m/s", 0.1), (1e3, "mm/s", 0.0)),
        "Pa": ((1e-6, "MPa", 1e6), (1e-5, "bar", 1e4), (1.0, "Pa", 0.0)),
        "m2": ((1.0, "m²", 0.1), (1e4, "cm²", 0.0)),
        "Hz": ((1e-3, "kHz", 1e3), (1.0, "Hz", 0.0)),
    }
    choices = scales.get(units, ()) if largest else ()  # 0 m/s, not 0 mm/s
    for factor, name, least in choices:
        if abs(largest) >= least:
            return factor, name
    return 1.0, plain_unit(units)


def plain_unit(units: str) -> str:
    """A CF unit as people write it: m/s, N s/m, rad/s."""
    if units == "1":
        return ""
    if not re.fullmatch(
        r"[A-Za-z\d -]*", units
    ):  # no CF unit: a state's own, like rad/s
        return units
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
    """Return the quantity that a CF unit measures, and an example of how people write it."""
    units = "1" if units in {"", "-"} else units
    plain = plain_unit(units)
    return QUANTITIES.get(units, (f"a value in {plain}", f"1 {plain}"))


def with_unit(value: float, units: str) -> str:
    """A value of a CF unit as people write it: 4 kN, 0.5714 mm."""
    factor, name = shown_in(value, units)
    return f"{value * factor:.4g} {name}".rstrip()


def engineering(value: float, units: str, digits: int = 3) -> str:
    """Write a quantity for sentences and tables: 10 kN/mm, 829 Hz, 2.6·10⁻¹⁵ m."""
    factor, name = shown_in(value, units)
    return f"{number(value * factor, digits)} {name}".rstrip()


def _refuse_comma(tidy: str) -> None:
    """Raise if a text is a number with a comma, and suggest one without it."""
    match = re.compile(r"([+-]?\d*),(\d+)\s*(\D.*)?", re.ASCII).fullmatch(tidy)
    if match is None:
        return
    head, tail, unit = match.groups("")
    point = f"{head or 0}.{tail} {unit}".rstrip()
    if len(tail) != 3 or head.lstrip("+-") in {"", "0"}:  # separates no thousands
        raise UnitError(f"write a decimal point: {point}")
    whole = f"{head}{tail} {unit}".rstrip()
    raise UnitError(
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
    # Engineers' spellings that pint does not know, or takes for others: to pint Nm is a number
    # (of yarn) times a metre, and kmph a thousand miles per hour.
    spellings = (
        "newton_second = newton * second = Ns",
        "newton_meter = newton * meter = Nm",
        "newton_millimeter = newton * millimeter = Nmm",
        "kilopond = kilogram_force = kp",
        "kilometer_in_an_hour = kilometer / hour = kmh = kmph",
        "@alias pound = lbm",
    )
    for words in spellings:
        registry.define(words)
    return registry


@lru_cache(maxsize=256)
def _unit(text: str) -> Any:
    """A unit of pint; None if it is none."""
    import tokenize

    from pint.errors import PintError

    # the tokenizer and evaluator below pint fail in their own ways on what is no expression
    failures = (PintError, ValueError, TypeError, AttributeError, AssertionError)
    # units in other languages; to pint km/t is one of a kilometre and a ton
    abroad = (
        dict.fromkeys(("km/t", "km/tim", "km/std", "km/u", "км/ч"), "km/h")
        | {"m/sek": "m/s", "м/с": "m/s", "мм/с": "mm/s", "кН": "kN", "Н": "N"}
        | {"мкм": "µm", "мм": "mm", "м": "m"}
    )
    try:
        text = abroad.get(text, text)
        if text in {"", "-"}:  # as states have it that have no unit
            text = "1"
        text = text.replace("U/min", "rpm")  # German; U is an enzyme's unit to pint
        # m.s-1: pint multiplies at a point until its version 0.25 only
        text = re.sub(r"(?<=\w)\.(?=[^\W\d])", "*", text)
        # m s-1, cm2: CF writes powers without a sign
        return _registry().parse_units(re.sub(r"(?<=[^\W\d])(-?\d)", r"**\1", text))
    except (*failures, ArithmeticError, SyntaxError, tokenize.TokenError, LookupError):
        return None


def _measures(unit: Any, units: str) -> bool:
    """Tell whether a unit measures the same as a CF unit."""
    target = _unit(units)
    if unit.dimensionality != target.dimensionality:
        return False
    if target.dimensionless:
        if _names_any(target, TURNS):
            return str(unit) in TURNS
        ratio = "/" in str(unit) and not _names_any(unit, TURNING)  # as N/kN
        # pint takes angles for plain numbers, too
        return ratio or str(unit) in ("percent", "permille", "ppm", "dimensionless")
    if units == "Hz":  # not rad/s, nor a rate in 1/s
        return _names_any(unit, CYCLES)
    per_second = _registry().parse_units("1/s").dimensionality
    return unit.dimensionality != per_second or _turns_of(unit, target) is not None


def _wrong_kind(unit: Any, units: str, keys: Mapping[str, str] | None) -> str:
    """Explain what a unit measures, what is needed, and which inputs take what was written."""
    kind = next((units for units in QUANTITIES if _measures(unit, units)), None)
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
    gravity = _registry().parse_units("m/s**2").dimensionality
    of_weight = unit.dimensionality * gravity == _unit(units).dimensionality
    weight = " (a weight is written lbf or kgf)" if of_weight else ""
    return f"{is_kind}; {what} is needed, like {example}{weight}{elsewhere}"
