"""Numbers of a configuration that may be texts with a unit: ``t_end: 20 ms``.

Keys that count in units of the study, like times in √(m/k1), take plain numbers in these, or a
text with a unit, which is turned into them by the study's own parameters.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from squealpipe.inputs import parse_angle
from squealpipe.parameters import KEYS_THAT_TAKE, Parameters
from squealpipe.systems.inputs.units import has_unit, number_of


@dataclass(frozen=True)
class In:
    """Marks a number of the configuration that may be a text with a unit.

    Attributes:
        units: CF unit.
        of_study: the key counts in the study's own unit of that kind (:func:`scales`), angles
            in π.
    """

    units: str
    of_study: bool = False

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.with_info_before_validator_function(
            self._read, handler(source)
        )

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        text = {"type": "string"}
        if self.units != "rad":  # pi/4 has no number before it
            # JSON schema of a text with a unit: it begins as a number and goes on
            text["pattern"] = r"^\s*[-+−]?(\d|\.\d).*[^\d\s.].*$"
        return {"anyOf": [handler(schema), text]}

    def _read(self, value: Any, info: ValidationInfo) -> Any:
        if self.units == "rad" and isinstance(value, str):
            return _over_pi(value)
        number = number_of(value, self.units, KEYS_THAT_TAKE)
        if not self.of_study or number is value or not isinstance(number, float):
            return number
        if info.context is None:
            raise ValueError("a unit is read in a whole configuration alone")
        return number / info.context.get(self.units, 1.0)


def _over_pi(text: str) -> Any:
    """An angle over π from a text with a unit, to the last digit that people write."""
    if has_unit(text) or "pi" in text or "π" in text:
        return float(f"{parse_angle(text) / math.pi:.15g}")
    return text


def scales(parameters: Parameters) -> Mapping[str, float]:
    """CF unit → the study's own unit of that kind, in SI."""
    return {
        "s": parameters.time_unit,
        "m": parameters.preload,
        "m-1": 1.0 / parameters.preload,
        "m s-1": parameters.preload / parameters.time_unit,
        "N s m-1": math.sqrt(parameters.k1 * parameters.mass),
    }
