"""Sections of a study of one's own: its scenes and sweeps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import ConfigDict, Field, ValidationInfo, WithJsonSchema, field_validator

from squealpipe.inputs import parse_angle
from squealpipe.ranges import read_fixed, read_values
from squealpipe.study.configuration.quantities import In
from squealpipe.study.configuration.sections import Number, Section, Time

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]


class InitialState(Section):
    """Displacements and velocities at the start, m and m/s."""

    x: Annotated[Number, In("m")] = 0.0
    y: Annotated[Number, In("m")] = 0.0
    vx: Annotated[Number, In("m s-1")] = 0.0
    vy: Annotated[Number, In("m s-1")] = 0.0


class OwnScene(Section):
    """A scene of a study of one's own; angles like 30deg, 0.4pi or rad, t_end in √(m/k1)."""

    model_config = ConfigDict(
        # angles may follow from the stiffness of the parameters
        json_schema_extra=lambda schema: schema.pop("required", None) and None
    )
    alpha1: Annotated[Number, WithJsonSchema({"type": ["string", "number"]})]
    alpha2: Annotated[Number, WithJsonSchema({"type": ["string", "number"]})]
    start: InitialState = InitialState()
    t_end: Time = 200.0

    @field_validator("alpha1", "alpha2", mode="before")
    @classmethod
    def _as_people_write(cls, angle: Any) -> Any:
        return (
            parse_angle(str(angle)) if isinstance(angle, str | int | float) else angle
        )


SWEPT_VALUES = {
    "type": ["string", "number", "array"],
    "items": {"type": ["string", "number"]},
}


class SweepSection(Section):
    """A task over ranges, written as for ``squealpipe sweep``; results in data/sweeps/<name>.nc."""

    task: str
    vary: Annotated[
        dict[Name, list[float | int]],
        Field(min_length=1),
        WithJsonSchema(
            {"type": "object", "minProperties": 1, "additionalProperties": SWEPT_VALUES}
        ),
    ]
    fixed: dict[Name, float | int | str | bool | list[float | int] | None] = Field(
        default={}
    )

    @field_validator("vary", "fixed", mode="before")
    @classmethod
    def _written_forms(cls, entries: Any, info: ValidationInfo) -> Any:
        """Ranges and angles as numbers, so that each way to write them is the same."""
        if not isinstance(entries, Mapping):
            return entries
        read = read_values if info.field_name == "vary" else read_fixed
        forms, faults = {}, []
        for name, value in entries.items():
            try:
                forms[name] = read(name, value, info.data.get("task", ""))
            except ValueError as error:
                faults.append(f"{name}: {error}")
        if faults:
            raise ValueError("; ".join(faults))
        return forms
