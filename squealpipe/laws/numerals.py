"""Numbers as five continents write them: 1.234,5; 1 234,5; 1'234.5; 1,234.5; 1,23,456; 1.5D-03.

One cell may not tell what its comma or point is: ``1,234`` is either. The cells of a table tell
it together, and where they do not, the table is refused.
"""

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

MAY_BE_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}([.,])\d{3}", re.ASCII)
_GROUPED = {
    # thousands, and in India hundreds of thousands; with a decimal sign behind, or several groups
    "point": re.compile(
        r"[+-]?(?=.*\.|.*,.*,)(\d{1,3}(,\d{3})+|\d{1,2}(,\d{2})+,\d{3})(\.\d*)?",
        re.ASCII,
    ),
    "comma": re.compile(r"[+-]?(?=.*,|.*\..*\.)\d{1,3}(\.\d{3})+(,\d*)?", re.ASCII),
}


class Numeral(NamedTuple):
    """A number as it is written, and the unit behind it, if there is one."""

    text: str
    unit: str


def numeral(cell: str) -> Numeral | None:
    """A cell of a number, maybe with a unit; None if it is none."""
    # word processors write minus signs, dashes and exponents with signs of their own
    signs = str.maketrans("−–⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "---0123456789")
    text = cell.strip().translate(signs)
    # 1.5 × 10^-3 and its like
    times_ten = re.compile(
        r"(?<=[\d.,])\s*[×·*x]\s*10\s*(?:\^|\*\*)?\s*\(?([+-]?\d{1,3})\)?"
    )
    # Fortran writes 1.5D-3
    exponent = re.compile(r"(?<=[\d.,])[dD](?=[+-]?\d{1,3}(?!\d))")
    text = exponent.sub("e", times_ten.sub(r"e\1", text))
    # Between thousands: blanks of four widths.
    blanks = "\u0020\u00a0\u2009\u202f"
    if match := re.match(rf"[+-]?\d{{1,3}}([{blanks}'’]\d{{3}})+(?!\d)", text):
        whole = re.sub(rf"[{blanks}'’]", "", match[0])
        text = whole + text[match.end() :]
    number_and_unit = re.compile(
        r"([+-]?(?:\d[\d.,]*|[.,]\d+)(?:[eE][+-]?\d{1,3})?)\s*([^\d\s.,_].*)?", re.ASCII
    )
    match = number_and_unit.fullmatch(text)
    if match is None or not _is_number(_mantissa(match[1])):
        return None
    return Numeral(match[1], match[2] or "")


def decimal_sign(cells: Iterable[tuple[str, str]], separator: str) -> str:
    """Return the decimal sign of numbers as they are written, "point" or "comma".

    Args:
        cells: where each number stands, and its :attr:`Numeral.text`.
        separator: what separates the cells; between commas a point separates no thousands.

    Raises:
        ValueError: it cannot be known; says where, and what to write.
    """
    proven: dict[str, tuple[str, str]] = {}
    undecided: dict[str, tuple[str, str]] = {}
    grouped = False
    for where, text in cells:
        mantissa = _mantissa(text)
        # the point of 1.000E+03 is a decimal one: one digit stands before it
        scientific = text != mantissa and re.compile(r"[+-]?\d[.,]", re.ASCII).match(
            mantissa
        )
        if sign := next((s for s in _GROUPED if _GROUPED[s].fullmatch(mantissa)), None):
            grouped = True
            proven.setdefault(sign, (where, text))
        elif not scientific and (match := MAY_BE_THOUSANDS.fullmatch(mantissa)):
            undecided.setdefault("comma" if match[1] == "," else "point", (where, text))
        elif "," in mantissa:
            proven.setdefault("comma", (where, text))
        elif "." in mantissa:
            proven.setdefault("point", (where, text))
    if len(proven) == 1 and grouped:  # the other sign separates thousands everywhere
        return next(iter(proven))
    seen = {**undecided, **proven}
    if len(seen) == 2:
        (comma_at, comma), (point_at, point) = seen["comma"], seen["point"]
        raise ValueError(
            f"{comma_at}: {comma!r} has a comma and {point!r} in {point_at} a point; "
            "write one decimal sign throughout, and no thousands"
        )
    sign = next(iter(seen), "point")
    if undecided and not proven and (sign == "comma" or separator != ","):
        where, text = undecided[sign]
        fraction = text.replace(",", ".") if sign == "comma" else f"{text}0"
        whole = re.sub(r"[.,]", "", text, count=1)
        raise ValueError(
            f"{where}: the {sign} of {text!r} may separate thousands; "
            f"write {fraction} or {whole}"
        )
    return sign


def plain(text: str, sign: str) -> str:
    """A number with a decimal point and no thousands."""
    thousands = {"point": ",", "comma": "."}
    return text.replace(thousands[sign], "").replace(",", ".")


def _mantissa(text: str) -> str:
    return re.split("[eE]", text)[0]


def _is_number(mantissa: str) -> bool:
    plain = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|[.,]\d+)", re.ASCII)
    return any(form.fullmatch(mantissa) for form in (plain, *_GROUPED.values()))


def are_numbers(cells: Sequence[str]) -> bool:
    """Return whether all cells are numbers without a unit."""
    read = [numeral(cell) for cell in cells]
    return all(number is not None and not number.unit for number in read)
