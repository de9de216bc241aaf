"""Words for people: numbers in sentences, labels and tables, and the name that was meant."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits and sign of an exponent in plain text."""
LONGEST_PLAIN = 6
"""Digits before the point up to which a number is written out."""


def number(value: float, digits: int = 3) -> str:
    """A number as people write it: 1326, −0.0042, 2.6·10⁻¹⁵, 10⁻⁸."""
    written_out = 10**digits <= abs(value) < 10**LONGEST_PLAIN
    return as_people_write(f"{value:.0f}" if written_out else f"{value:.{digits}g}")


def as_people_write(text: str) -> str:
    """A text with its numbers as people write them: 4.42e+03 becomes 4420, and -2 −2."""

    def written(match: re.Match[str]) -> str:
        exponent = int(match[2])
        if 0 <= exponent < LONGEST_PLAIN:
            return f"{float(match[0]):.0f}"
        power = f"10{str(exponent).translate(RAISED)}"
        return power if match[1] == "1" else f"{match[1]}·{power}"

    plain = re.sub(r"\b(\d+(?:\.\d+)?)e([+-]\d+)", written, text)
    return re.sub(r"(?<![\w)-])-(?=[\d.]|inf)", "−", plain)


def nearest(wrong: object, names: Iterable[str]) -> str | None:
    """The name that is near enough to have been meant, if there is one."""
    every = list(names)
    near = difflib.get_close_matches(str(wrong), every, n=1) or difflib.get_close_matches(
        str(wrong), [name for name in every if len(name) == len(str(wrong))], n=1, cutoff=0.5
    )
    return near[0] if near else None


def suggestion(wrong: object, names: Iterable[str]) -> str:
    """``did you mean 'mu'?``, or all names where none is near."""
    every = list(names)
    near = nearest(wrong, every)
    return f"did you mean {near!r}?" if near else f"choose from {', '.join(every)}"
