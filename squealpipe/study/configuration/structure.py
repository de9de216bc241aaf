"""Sections of a study of a structure: its file, how it is run, modifications, operating points."""

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, WithJsonSchema

from squealpipe.study.configuration.own import Name
from squealpipe.study.configuration.quantities import In
from squealpipe.study.configuration.sections import Positive, Section, whole_validator


class StructureSection(Section):
    """A structure in a file; beside it the options of ``squealpipe squeal``."""

    file: str
    samples: Annotated[int, Field(ge=1, le=100_000), whole_validator] = 64
    seed: Annotated[int, Field(ge=0), whole_validator] = 0
    t_end: Annotated[Positive, In("s")] | None = None
    n_modes: Annotated[int, Field(ge=1), whole_validator] | None = None
    frequency_max: Annotated[Positive, In("Hz")] | None = None


Modifications = dict[Name, dict[str, dict[str, float | int | str | tuple[int, ...]]]]
"""Name → kind → place or property → largest amount, as ``assess`` takes them; degrees of freedom
are counted from 1, like ``weight: {added_mass: {12: 0.1 kg}}``."""

Axis = Annotated[
    str | float | int | tuple[str | float | int, ...],
    WithJsonSchema(
        {"type": ["string", "number", "array"], "items": {"type": ["string", "number"]}}
    ),
]
"""Values of a quantity: a number, a list of them or first:last:count; texts may have a unit."""


class OperatingSection(Section):
    """Operating points of the structure; keys are those of ``operating_map``."""

    pressure: Axis | None = None
    speed: Axis | None = None
    mu: Axis | None = None
    temperature: Axis | None = None
    mu_of: dict[str, str | dict[str, float]] | None = None
    measured: str | None = None
    frequency_band: Annotated[Positive, In("1")] = 0.05
    band_edges: Axis | None = None
    tol: Positive = 1e-12

    @property
    def longest(self) -> int:
        """Number of values of the axis that has most, along which a map is split into jobs."""
        axes = (self.pressure, self.speed, self.mu, self.temperature)
        return max(_count(axis) for axis in axes)


def _count(axis: Any) -> int:
    """Return the number of values of an axis as it is written: first:last:count, or a list."""
    if isinstance(axis, str):
        _, *rest = axis.split(":")
        return int(rest[1]) if len(rest) > 1 else 1 + axis.count(",")
    return len(axis) if isinstance(axis, tuple) else 1


def files_of_operating(
    content: Mapping[str, Any],
) -> Iterator[tuple[dict[str, Any], str]]:
    """Yield the mapping and the key of each file that the section ``operating`` names."""
    section = content.get("operating")
    if not isinstance(section, dict):
        return
    if isinstance(section.get("measured"), str):
        yield section, "measured"
    tables = section.get("mu_of")
    if not isinstance(tables, dict):
        return
    for name, table in tables.items():
        if isinstance(table, str) and ":" not in table:  # 20:0.45 300:0.35 is no file
            yield tables, name


def file_in(content: Mapping[str, Any]) -> str | None:
    """The file that a configuration names, as it names it."""
    section = content.get("structure")
    file = section.get("file") if isinstance(section, Mapping) else None
    return file if isinstance(file, str) else None


def place_files(config: Path, content: dict[str, Any]) -> Iterator[str]:
    """Rewrite file names of the configuration for the working directory; yield faults."""
    file = file_in(content)
    named: list[tuple[dict[str, Any], str, str, str]] = []
    if file is not None:
        remedy = "or `squealpipe init NAME.yaml --structure` writes an example"
        named.append((content["structure"], "file", "structure.file", remedy))
    for section, key in files_of_operating(content):
        where = f"operating.{key if key == 'measured' else f'mu_of.{key}'}"
        named.append((section, key, where, "or leave it out"))
    here = Path.cwd()
    for section, key, where, remedy in named:
        path = Path(os.path.normpath(here / config.parent / section[key]))
        if not path.is_file():
            yield (
                f"{where} = {section[key]!r}: no file {path}; name it relative to the folder of "
                f"the configuration, {remedy}"
            )
        section[key] = (
            path.relative_to(here).as_posix()
            if path.is_relative_to(here)
            else str(path)
        )
