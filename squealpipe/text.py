"""Words for people, of numbers and of names: the public name of what systems has."""

from squealpipe.systems.inputs.words import (
    LONGEST_PLAIN,
    RAISED,
    as_number,
    as_people_write,
    duration,
    in_words,
    nearest,
    number,
    off_by,
    part_of_time,
    percent,
    suggestion,
)

__all__ = [
    "LONGEST_PLAIN",
    "RAISED",
    "as_number",
    "as_people_write",
    "duration",
    "in_words",
    "nearest",
    "number",
    "off_by",
    "part_of_time",
    "percent",
    "suggestion",
]
