"""Mistakes in a configuration, in words: key path, value, what is allowed, the nearest key."""

import fnmatch
import re
import typing
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from squealpipe.parameters import SYMBOLS
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import in_words, nearest


class ConfigError(ValueError):
    """The configuration has mistakes; the message lists all of them.

    Args:
        files: that the user may correct, named in the message.
    """

    def __init__(self, mistakes: Sequence[str], files: Sequence[object] = ()) -> None:
        self.mistakes = list(mistakes)
        named = f" ({', '.join(map(_relative, files))})" if files else ""
        super().__init__(
            f"the configuration{named} has mistakes:\n"
            + "\n".join(f"  {m}" for m in mistakes)
        )


def _relative(file: object) -> str:
    """Return the path of a file from the working directory if it lies below."""
    path = Path(str(file))
    return str(
        path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
    )


def mistakes(error: ValidationError, model: type[BaseModel]) -> Iterator[str]:
    """One line for each fault that validation of ``model`` found."""
    faults = error.errors(include_url=False)
    inner = {fault["loc"][:-1] for fault in faults}
    for fault in faults:
        if fault["type"] == "too_short" and fault["loc"] in inner:
            continue  # its items were refused one by one
        path = ".".join(map(str, fault["loc"])) or "the configuration"
        if fault["type"] == "extra_forbidden":
            yield f"{path}: unknown key; {_nearest(fault['loc'], model)}"
        elif fault["type"] == "missing":
            yield f"{path}: {in_words(fault)}"
        else:  # an error of ours says what to do
            remedy = "" if fault["type"] == "value_error" else _remedy(fault["input"])
            yield f"{path} = {brief(fault['input'])}: {in_words(fault)}{remedy}"


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
    siblings = [
        path for path in every if fnmatch.fnmatchcase(stem, path.rpartition(".")[0])
    ]
    names = [path.rpartition(".")[2] for path in siblings]
    near = SYMBOLS.get(wrong) if SYMBOLS.get(wrong) in names else nearest(wrong, names)
    if near:
        return f"did you mean {near!r}?"
    elsewhere = [path for path in every if path.rpartition(".")[2] == wrong]
    if elsewhere:
        return f"did you mean {' or '.join(elsewhere)}?"
    return f"known: {', '.join(sorted(path.rpartition('.')[2] for path in siblings))}"


def _section(annotation: Any) -> type[BaseModel] | None:
    """The model inside an annotation (plain, optional, or in a list), if there is one."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_section, typing.get_args(annotation))), None)


def _remedy(value: object) -> str:
    if isinstance(value, str) and ("pi" in value or "π" in value):
        return "; write angles as plain numbers, in multiples of π"
    number = isinstance(value, str) and re.fullmatch(
        r"\s*[-+]?[\d.]+([eE][-+]?\d+)?\s*", value
    )
    return "; write numbers without quotes" if number else ""
