"""Words for people: numbers in sentences, labels and tables, and the name that was meant."""

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
