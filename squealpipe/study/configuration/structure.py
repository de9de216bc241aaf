"""The section ``structure`` of a study: a structure in a file, and how it is run."""

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from squealpipe.study.configuration.quantities import In
from squealpipe.study.configuration.sections import WHOLE, Positive, Section


class StructureSection(Section):
    """A structure in a file; beside it the options of ``squealpipe squeal``."""

    file: str
    samples: Annotated[int, Field(ge=1, le=100_000), WHOLE] = 64
    seed: Annotated[int, Field(ge=0), WHOLE] = 0
    t_end: Annotated[Positive, In("s")] | None = None
    n_modes: Annotated[int, Field(ge=1), WHOLE] | None = None
    frequency_max: Annotated[Positive, In("Hz")] | None = None


def file_in(content: Mapping[str, Any]) -> str | None:
    """The file that a configuration names, as it names it."""
    section = content.get("structure")
    file = section.get("file") if isinstance(section, Mapping) else None
    return file if isinstance(file, str) else None


def place_file(config: Path, content: dict[str, Any]) -> Iterator[str]:
    """Name the file from where one is instead of from the configuration's folder; faults."""
    file = file_in(content)
    if file is None:
        return
    path = Path(os.path.normpath(Path.cwd() / config.parent / file))
    if not path.is_file():
        yield (
            f"structure.file = {file!r}: no file {path}; name it relative to the folder of the "
            "configuration, or `squealpipe init NAME.yaml --structure` writes an example"
        )
    here = Path.cwd()
    content["structure"]["file"] = (
        path.relative_to(here).as_posix() if path.is_relative_to(here) else str(path)
    )
