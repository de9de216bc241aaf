"""Mistakes in a configuration, in words: key path, value, what is allowed, the nearest key."""

from __future__ import annotations

import difflib
import fnmatch
import math
import re
import typing
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel, ValidationError

NUMBER_AS_TEXT = re.compile(r"\s*[-+]?[\d.]+([eE][-+]?\d+)?\s*")

LONGEST = 80
"""Characters of a value that a message quotes."""


class ConfigError(ValueError):
    """The configuration has mistakes; the message lists all of them."""

    def __init__(self, mistakes: Sequence[str]) -> None:
        self.mistakes = list(mistakes)
        super().__init__(
            "the configuration has mistakes:\n" + "\n".join(f"  {m}" for m in mistakes)
        )


def mistakes(error: ValidationError, model: type[BaseModel]) -> Iterator[str]:
    """One line for each fault that validation of ``model`` found."""
    for fault in error.errors(include_url=False):
        path = ".".join(map(str, fault["loc"])) or "the configuration"
        if fault["type"] == "extra_forbidden":
            yield f"{path}: unknown key; {_nearest(fault['loc'], model)}"
            continue
        message = fault["msg"].removeprefix("Value error, ")
        if fault["type"] == "value_error":  # one of ours, which says what to do
            yield f"{path} = {_quoted(fault['input'])}: {message}"
            continue
        message = message[0].lower() + message[1:]
        yield f"{path} = {_quoted(fault['input'])}: {message}{_remedy(fault['input'])}"


def known_keys(model: type[BaseModel], stem: str = "") -> Iterator[str]:
    """Dotted paths of all keys of a model; ``*`` stands for a name that is free."""
    for name, entry in model.model_fields.items():
        path = f"{stem}.{name}" if stem else name
        yield path
        section = _section(entry.annotation)
        if section is not None:
            free = typing.get_origin(entry.annotation) is dict
            yield from known_keys(section, f"{path}.*" if free else path)


def _nearest(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    *above, wrong = [str(key) for key in location if not isinstance(key, int)]
    stem = ".".join(above)
    every = list(known_keys(model))
    siblings = [path for path in every if fnmatch.fnmatchcase(stem, path.rpartition(".")[0])]
    near = difflib.get_close_matches(wrong, [path.rpartition(".")[2] for path in siblings], n=1)
    if near:
        return f"did you mean {near[0]!r}?"
    elsewhere = [path for path in every if path.rpartition(".")[2] == wrong]
    if elsewhere:
        return f"did you mean {' or '.join(elsewhere)}?"
    return f"known: {', '.join(sorted(path.rpartition('.')[2] for path in siblings))}"


def _section(annotation: Any) -> type[BaseModel] | None:
    """The model inside an annotation (plain, optional, or in a list), if there is one."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_section, typing.get_args(annotation))), None)


def _quoted(value: object) -> str:
    try:
        text = repr(value)
    except ValueError:  # an integer of more digits than Python prints
        return "a number of more than 4000 digits"
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"


def _remedy(value: object) -> str:
    if isinstance(value, str) and ("pi" in value or "π" in value):
        return "; write angles as plain numbers, in multiples of π"
    if isinstance(value, float) and not math.isfinite(value):
        return "; a finite number is needed"
    return "; write numbers without quotes" if _is_number_as_text(value) else ""


def _is_number_as_text(value: object) -> bool:
    return isinstance(value, str) and NUMBER_AS_TEXT.fullmatch(value) is not None
