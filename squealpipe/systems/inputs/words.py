"""Words for people: numbers in sentences, labels and tables, and the name that was meant."""

import difflib
import functools
import inspect
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

Made = TypeVar("Made")

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits and sign of an exponent in plain text."""
LONGEST_PLAIN = 6
"""Digits before the point up to which a number is written out."""


def in_words(fault: Mapping[str, Any]) -> str:
    """Return a fault that pydantic found as a sentence about what is allowed; words of our own
    errors stay.
    """
    message = str(fault["msg"]).removeprefix("Value error, ")
    if fault["type"] == "value_error":
        return message
    # what is allowed, by the kind of fault that pydantic names
    needs = {
        "callable_type": "a function is needed",
        "sequence_str": "a list of names is needed",
        "model_type": "keys and values are needed, like `points: 31`",
        "dict_type": "names and values are needed, like `name: [0.3, 0.9]`",
        "tuple_type": "a list is needed, like [0.3, 0.9]",
        "list_type": "a list is needed, like [0.3, 0.9]",
        "float_type": "a number is needed",
        "int_type": "a whole number is needed",
        "bool_type": "true or false is needed",
        "mapping_type": "a mapping of names to values is needed",
        "is_instance_of": "it must be {class}",
        "dataclass_exact_type": "{class_name}(...) are needed",
        "string_type": "text is needed",
        "string_pattern_mismatch": "only letters, digits and . _ / - are allowed",
        "finite_number": "a finite number is needed",
        "greater_than": "it must be greater than {gt:g}",
        "less_than": "it must be less than {lt:g}",
        "greater_than_equal": "it must be {ge:g} or greater",
        "less_than_equal": "it must be {le:g} or less",
        "literal_error": "choose from {expected}",
        "too_short": "{min_length} or more items are needed",
        "too_long": "at most {max_length} items are allowed",
        "missing": "this key is needed",
    }
    known = needs.get(fault["type"], message[0].lower() + message[1:])
    return known.format(**fault.get("ctx", {}))


def number(value: float, digits: int = 3) -> str:
    """A number as people write it: 1326, −0.0042, 2.6·10⁻¹⁵, 10⁻⁸."""
    written_out = 10**digits <= abs(value) < 10**LONGEST_PLAIN
    return as_people_write(f"{value:.0f}" if written_out else f"{value:.{digits}g}")


def as_number(text: str) -> float:
    """The number of a text; NaN where it is none, as ``1_000``, which Python takes for one."""
    try:
        return math.nan if "_" in text else float(text)
    except ValueError:
        return math.nan


def percent(share: float, digits: int = 2) -> str:
    """A share in per cent."""
    return f"{number(100.0 * share, digits)} %"


def off_by(share: float) -> str:
    """Return a relative difference in words: ``3 % above``, ``0.2 % below``."""
    return f"{percent(abs(share))} {'above' if share > 0 else 'below'}"


def part_of_time(share: float) -> str:
    """Return a share of the time in per cent; runs do not resolve less than 0.1 %."""
    return "< 0.1 %" if 0.0 < share < 1e-3 else percent(share)


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


def duration(seconds: float) -> str:
    """Seconds for people: 0.4 s, 17 s, 3 min 20 s, 2 h 5 min, 12 days."""
    if seconds < 10:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    if whole < 7200:
        return f"{whole // 60} min {whole % 60} s"
    if whole < 172_800:
        return f"{whole // 3600} h {whole % 3600 // 60} min"
    return f"{whole // 86_400} days"


def nearest(wrong: object, names: Iterable[str]) -> str | None:
    """The name that is near enough to have been meant, if there is one."""
    every = list(names)
    near = difflib.get_close_matches(
        str(wrong), every, n=1
    ) or difflib.get_close_matches(
        str(wrong),
        [name for name in every if len(name) == len(str(wrong))],
        n=1,
        cutoff=0.5,
    )
    return near[0] if near else None


def suggestion(wrong: object, names: Iterable[str]) -> str:
    """``did you mean 'mu'?``, or all names where none is near."""
    every = list(names)
    near = nearest(wrong, every)
    return (
        f"did you mean {near!r}?"
        if near
        else f"choose from {', '.join(every) or 'none'}"
    )


def says_what_was_meant(made: type[Made]) -> type[Made]:
    """Have a class say, where an argument is unknown, which one was meant."""
    make: Any = made.__init__
    names = list(inspect.signature(made).parameters)

    @functools.wraps(make)
    def named(self: Any, *args: Any, **kwargs: Any) -> None:
        try:
            make(self, *args, **kwargs)
        except TypeError as error:
            unknown = next((name for name in kwargs if name not in names), None)
            if unknown is None:
                raise
            raise TypeError(
                f"{type(self).__name__}: {unknown}: unexpected keyword argument; "
                f"{suggestion(unknown, names)}"
            ) from error

    made.__init__ = named  # type: ignore[method-assign]
    return made
