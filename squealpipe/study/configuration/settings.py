"""The study configuration: validated types, one section a topic, and canonical slices.

An overlay (``--configfile mine.yaml``) is merged over ``workflow/config/paper.yaml`` by
Snakemake; :func:`read_study` does the same for the command line.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import reduce
from operator import getitem
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from squealpipe.laws.table_files import ENDINGS
from squealpipe.laws.tables import named, stood_for
from squealpipe.parameters import TABLE, Parameters, Row
from squealpipe.ranges import sweep_config
from squealpipe.store.mistakes import ConfigError, mistakes
from squealpipe.store.rerun.key import PARTS
from squealpipe.store.rerun.sources import WORKFLOW
from squealpipe.store.yaml_files import flat, overlay, read_yaml
from squealpipe.study.configuration import sections
from squealpipe.study.configuration.own import Name, OwnScene, SweepSection
from squealpipe.study.configuration.quantities import scales
from squealpipe.study.configuration.sections import Section
from squealpipe.study.configuration.structure import (
    Modifications,
    OperatingSection,
    StructureSection,
    place_files,
)
from squealpipe.substitutes import rivals, stands_for

PAPER = WORKFLOW / "config/paper.yaml"
"""The paper's study, over which other configurations are laid."""


class Study(Section):
    """A whole study."""

    results: Annotated[str, Field(pattern=r"^[\w./-]+$")] = "results"
    paper: bool = True
    reading: Literal["as_printed", "along_plus_x", "along_minus_x"] = "as_printed"
    scenes: dict[Name, OwnScene] = Field(default={})
    structure: StructureSection | None = None
    parameters: sections.ParametersSection = sections.ParametersSection()
    linear: sections.LinearSection = sections.LinearSection()
    inference: sections.InferenceSection = sections.InferenceSection()
    comparison: sections.ComparisonSection = sections.ComparisonSection()
    dynamics: sections.DynamicsSection = sections.DynamicsSection()
    backbones: sections.BackbonesSection = sections.BackbonesSection()
    cycles: sections.CyclesSection = sections.CyclesSection()
    robustness: sections.RobustnessSection = sections.RobustnessSection()
    contact_points: sections.ContactPointsSection = sections.ContactPointsSection()
    explorer: sections.ExplorerSection = sections.ExplorerSection()
    modifications: Modifications = Field(default={})
    operating: OperatingSection | None = None
    sweeps: dict[Name, SweepSection] = Field(default={})

    @field_validator("results")
    @classmethod
    def _is_a_folder_of_its_own(cls, value: str) -> str:
        path = PurePosixPath(value)
        frozen = "/results/archive/" in f"/{path}/"
        if ".." in path.parts or path.parts in {(), ("/",)} or frozen:
            raise ValueError(
                "a run needs a folder of its own, outside results/archive; write for instance "
                "results/mine"
            )
        return value

    @model_validator(mode="after")
    def _has_something_to_show(self) -> Self:
        if self.structure is not None:
            if self.paper or self.scenes:
                raise ValueError(
                    "structure: it has a study of its own; write paper: false, and scenes into "
                    "another configuration"
                )
        elif self.operating is not None or self.modifications:
            section = "modifications" if self.modifications else "operating"
            raise ValueError(
                f"{section}: a study of a structure alone has them; write structure: {{file: "
                "pad.yaml} beside it"
            )
        elif not self.paper and not self.scenes:
            raise ValueError(
                "paper: false makes a report of scenes of your own and needs one; write for "
                "instance scenes: {mine: {alpha1: 30deg, alpha2: 140deg}}, or structure: {file: "
                "pad.yaml}"
            )
        return self

    def slice(self, *paths: str) -> dict[str, Any]:
        """Return a canonical part of the configuration: numbers cast, keys in a fixed order.

        Args:
            paths: dotted keys, for instance ``"parameters"`` or ``"linear.points"``.
        """
        whole = self.model_dump(mode="json")
        part = {path: reduce(getitem, path.split("."), whole) for path in sorted(paths)}
        return json.loads(json.dumps(part, sort_keys=True))  # type: ignore[no-any-return]

    def changes_of(self, other: Self) -> list[tuple[str, Any, Any]]:
        """Return (dotted key, value there, value here) for each difference from another study.

        The folder of results and the sweeps are not compared.
        """
        theirs, ours = (
            flat(study.model_dump(mode="json", exclude={"results", "sweeps"}))
            for study in (other, self)
        )
        return [
            (key, theirs.get(key), ours.get(key))
            for key in dict.fromkeys([*theirs, *ours])
            if theirs.get(key) != ours.get(key)
        ]

    def sweep(self, name: str) -> dict[str, Any]:
        """Return the configuration of a sweep, completed by the study's parameters."""
        parameters = self.parameters.model_dump(mode="json")
        return sweep_config(
            **self.sweeps[name].model_dump(mode="json"), parameters=parameters
        )


def read_study(*paths: str | Path, changes: Mapping[str, Any] | None = None) -> Study:
    """Read and validate a study from YAML files; each file overrides those before it.

    Args:
        changes: keys and values that override those of all files.

    Raises:
        FileNotFoundError: a file is missing.
        ConfigError: every mistake found, with its key, value and what is allowed.
    """
    merged: dict[str, Any] = {}
    faults: list[str] = []
    for path in map(Path, paths):
        content = read_yaml(path)
        faults.extend(_read_laws(path, content))
        faults.extend(place_files(path, content))
        faults.extend(_lay_over(merged, content))
    faults.extend(_lay_over(merged, changes or {}))
    return parse_study(merged, faults, files_of_user(paths))


def files_of_user(paths: Iterable[str | Path]) -> list[str | Path]:
    """Return the files of a configuration that do not come with the package."""
    return [path for path in paths if Path(path).parent != PAPER.parent]


def _lay_over(base: dict[str, Any], top: Mapping[str, Any]) -> Iterator[str]:
    """Override keys of a configuration by those of another; yield the faults that this causes.

    Rivals are removed from below: ``preload_force`` above removes ``preload`` below, and the other
    way round, since both would set the same parameter.
    """
    below, above = base.get("parameters"), top.get("parameters")
    if isinstance(below, dict) and isinstance(above, Mapping):
        for name in [name for name in below if name not in above]:
            if not rivals(name, above):
                continue
            del below[name]
            stated = {
                target for other in above for target in (other, *stands_for(other))
            }
            for target in sorted({*stands_for(name)} - stated):
                yield (
                    f"parameters.{target}: is needed, for {name} of the configuration below "
                    "stands for it and goes; write both, or change that"
                )
    overlay(base, top)


def _read_laws(path: Path, content: dict[str, Any]) -> Iterator[str]:
    """Replace the files that a configuration names as laws by their content; yield faults."""
    section = content.get("parameters") or {}
    for name, law, row in laws_in(section):
        try:
            section[name] = named(law, row.laws.own_law_rules.columns, path.parent)
        except (OSError, ValueError) as error:
            yield f"parameters.{name}: {error}"
            del section[name]
            continue
        taken = ", ".join(
            other for other in stood_for(section[name], row.laws) if other in section
        )
        if section[name] != law and taken:
            yield f"parameters.{name}: the file stands for {taken}; leave that out"


def laws_in(section: Any) -> Iterator[tuple[str, Any, Row]]:
    """Yield (parameter, entry, row of the table) for each law that a section names."""
    for name, row in TABLE.items():
        if row.laws and isinstance(section, dict) and name in section:
            yield name, section[name], row


def files_of_laws(path: Path) -> list[Path]:
    """Return the files that a configuration names as laws, unresolved."""
    entries = [law for _, law, _ in laws_in(read_yaml(path).get("parameters"))]
    return [
        Path(file)
        for entry in entries
        for file in (entry.values() if isinstance(entry, dict) else [entry])
        if str(file).lower().endswith((*ENDINGS, ".py"))
    ]


def check_results_folder(results: str) -> None:
    """Refuse a folder of results in which Snakemake could overwrite or delete anything else."""
    folder = Path(results)
    below = sorted(folder.rglob("*"))
    for part in (folder, *(path for path in below if path.is_symlink())):
        inside = [part.resolve(), *part.resolve().parents]
        if any((at / "manifest.json").is_file() for at in inside):
            raise ConfigError(
                [f"results = {results!r}: {part} leads into the archive {inside[0]}"]
            )
    # endings of the files in each folder of results
    endings = dict(
        zip(
            PARTS,
            ((".nc",), (".png", ".svg"), (".html", ".pdf", ".json", ".xlsx", ".csv")),
            strict=True,
        )
    )
    for path in below:
        *above, name = path.relative_to(folder).parts
        hidden = any(part.startswith(".") for part in (*above, name))
        if (
            path.is_dir()
            or hidden
            or name == "README.md"
            or {"logs", "parts", "archive", "deposit"}.intersection(above)
        ):
            continue
        if not any(path.suffix in endings.get(part, ()) for part in above):
            what = f"it holds {path}, which is not a result; a run needs a folder of its own"
            raise ConfigError(
                [f"results = {results!r}: {what}, for instance results/mine"]
            )


def parse_study(
    content: Mapping[str, Any],
    faults: Sequence[str] = (),
    files: Sequence[str | Path] = (),
) -> Study:
    """Validate a configuration and return the study.

    Args:
        faults: messages about files, raised together with those of the validation.
        files: of the user, named in the message.

    Raises:
        ConfigError: every mistake found, with its key, value and what is allowed.
    """
    try:
        known = Study.model_fields  # a section without keys is the default one
        filled = {
            k: value
            for k, value in content.items()
            if value is not None or k not in known
        }
        plain = _plain(filled)
        study = Study.model_validate(plain, context=_complete(plain))
    except ValidationError as error:
        raise ConfigError([*faults, *mistakes(error, Study)], files) from error
    if faults:
        raise ConfigError(faults, files)
    return study


def _complete(content: dict[str, Any]) -> Mapping[str, float]:
    """Give scenes without angles the angles of ``stiffness``; return the study's own units.

    Faulty parameters are ignored here: the validation of the whole study reports them.
    """
    try:
        section = sections.ParametersSection.model_validate(
            content.get("parameters", {})
        )
    except ValidationError:
        return {}
    if section.stiffness is not None and isinstance(content.get("scenes"), Mapping):
        springs = section.stiffness.springs
        angles = {"alpha1": springs.alpha1, "alpha2": springs.alpha2}
        content["scenes"] = {
            name: {**angles, **(scene or {})}
            if isinstance(scene, Mapping | None)
            and not angles.keys() & {*(scene or {})}
            else scene
            for name, scene in content["scenes"].items()
        }
    return scales(Parameters(**section.model_dump()))


def _plain(value: Any) -> Any:
    """Return lists as tuples and all keys as text, so that a number as a key is reported."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return tuple(map(_plain, value))
    return value


def json_schema() -> str:
    """Return the text of ``workflow/config/schema.json``."""
    return json.dumps(Study.model_json_schema(), indent=2, sort_keys=True) + "\n"


if __name__ == "__main__":
    PAPER.with_name("schema.json").write_text(json_schema(), encoding="utf-8")
