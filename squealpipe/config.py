"""The study configuration: validated types, one section a topic, and canonical slices.

An overlay (``--configfile mine.yaml``) is merged over ``workflow/config/paper.yaml`` by
Snakemake; :func:`read_study` does the same for the command line.
"""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from squealpipe.parameters import Parameters, parameters_of

__all__ = [
    "ConfigError",
    "Section",
    "Study",
    "json_schema",
    "parameters_of",
    "parse_study",
    "read_study",
]


class ConfigError(ValueError):
    """The configuration has mistakes; the message lists all of them."""


class Section(BaseModel):
    """A part of the configuration: unknown keys and text for numbers are mistakes."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


Number = Annotated[float, Field(strict=True)]
Positive = Annotated[float, Field(gt=0)]
Points = Annotated[int, Field(ge=3, le=4001)]


class ParametersSection(Section):
    """Physical parameters, in consistent units."""

    mass: Positive = Parameters.mass
    k1: Positive = Parameters.k1
    k2: Positive = Parameters.k2
    k3: Positive = Parameters.k3
    mu: Annotated[float, Field(ge=0)] = Parameters.mu
    belt_speed: Number = Parameters.belt_speed
    preload: Positive = Parameters.preload
    length1: Positive = Parameters.length1
    length2: Positive = Parameters.length2
    sigma: Positive = Parameters.sigma


class LinearSection(Section):
    """Linear maps over both spring angles from 0 to π."""

    points: Points = 181


class Study(Section):
    """A whole study."""

    results: Annotated[str, Field(pattern=r"^[\w./-]+$")] = "results"
    parameters: ParametersSection = ParametersSection()
    linear: LinearSection = LinearSection()

    def slice(self, *paths: str) -> dict[str, Any]:
        """Canonical part of the configuration: numbers cast, keys in a fixed order.

        Args:
            paths: dotted keys, for instance ``"parameters"`` or ``"linear.points"``.
        """
        whole = self.model_dump(mode="json")
        part = {}
        for path in sorted(paths):
            value: Any = whole
            for key in path.split("."):
                value = value[key]
            part[path] = value
        return json.loads(json.dumps(part, sort_keys=True))  # type: ignore[no-any-return]


def read_study(*paths: str | Path) -> Study:
    """A validated study from one or several YAML files, later ones laid over earlier ones.

    Raises:
        FileNotFoundError: a file is missing.
        ConfigError: every mistake found, with its key, value and what is allowed.
    """
    merged: dict[str, Any] = {}
    for path in map(Path, paths):
        if not path.is_file():
            raise FileNotFoundError(f"no configuration {path}; give a YAML file that exists")
        try:
            content = yaml.safe_load(path.read_text(encoding="utf-8"))
        except yaml.YAMLError as error:
            raise ConfigError(f"{path} is not YAML: {error}") from error
        if not isinstance(content or {}, dict):
            raise ConfigError(f"{path} must hold keys and values, not {type(content).__name__}")
        _overlay(merged, content or {})
    return parse_study(merged)


def parse_study(content: Mapping[str, Any]) -> Study:
    """Validate a configuration mapping.

    Raises:
        ConfigError: as :func:`read_study`.
    """
    try:
        return Study.model_validate(_lists_to_tuples(dict(content)))
    except ValidationError as error:
        raise ConfigError(
            "the configuration has mistakes:\n" + "\n".join(_messages(error))
        ) from error


def _overlay(base: dict[str, Any], top: Mapping[str, Any]) -> None:
    for key, value in top.items():
        if isinstance(value, Mapping) and isinstance(base.get(key), dict):
            _overlay(base[key], value)
        else:
            base[key] = value


def _lists_to_tuples(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _lists_to_tuples(item) for key, item in value.items()}
    return tuple(map(_lists_to_tuples, value)) if isinstance(value, list) else value


def _messages(error: ValidationError) -> Iterator[str]:
    for fault in error.errors():
        path = ".".join(map(str, fault["loc"]))
        if fault["type"] == "extra_forbidden":
            known = _known_keys(fault["loc"][:-1])
            near = difflib.get_close_matches(str(fault["loc"][-1]), known, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"
            yield f"  {path}: unknown key; {hint}"
            continue
        value = fault["input"]
        remedy = ""
        if isinstance(value, str) and "pi" in value.replace("π", "pi"):
            remedy = "; write angles as plain numbers, in multiples of π"
        if isinstance(value, float) and not math.isfinite(value):
            remedy = "; a finite number is needed"
        yield f"  {path} = {value!r}: {fault['msg'][0].lower()}{fault['msg'][1:]}{remedy}"


def _known_keys(location: tuple[int | str, ...]) -> list[str]:
    model: Any = Study
    for key in location:
        annotation = model.model_fields[key].annotation if str(key) in model.model_fields else None
        if annotation is None or not isinstance(annotation, type):
            return []
        model = annotation
    return sorted(model.model_fields) if hasattr(model, "model_fields") else []


def json_schema() -> str:
    """The text of ``workflow/config/schema.json``."""
    return json.dumps(Study.model_json_schema(), indent=2, sort_keys=True) + "\n"
