"""Record what made a dataset in its attributes: parameters, model, method, tolerance, versions.

Every public task carries :func:`recorded`, so a dataset that is saved from a notebook states its
parameters as one of the study does. None of these attributes enters the dataset's id.
"""

import functools
import inspect
import json
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec

import numpy as np
import xarray as xr

from squealpipe.inputs import UNITS
from squealpipe.parameters import Parameters
from squealpipe.systems.datasets.versions import versions
from squealpipe.validation import checked

Given = ParamSpec("Given")

_recorded_calls: dict[str, tuple[str, str]] = {}
"""Task → model and method, as given to :func:`recorded`."""


def recorded(
    *, model: str = "", method: str = "", units: Mapping[str, str] = UNITS
) -> Callable[[Callable[Given, xr.Dataset]], Callable[Given, xr.Dataset]]:
    """Have a task check its arguments, and write what made its dataset into the attributes.

    Args:
        model: level of the model, where it is not an argument of the task.
        method: how it is computed, where that is not an argument.
        units: CF unit by name of the argument, for texts with a unit.
    """

    def decorate(task: Callable[Given, xr.Dataset]) -> Callable[Given, xr.Dataset]:
        named = inspect.signature(task).parameters.values()
        defaults = {
            each.name: each.default for each in named if each.kind != each.VAR_KEYWORD
        }
        _recorded_calls[task.__name__] = model, method

        @functools.wraps(task)
        def run(*args: Given.args, **kwargs: Given.kwargs) -> xr.Dataset:
            dataset = task(*args, **kwargs)
            given = defaults | dict(zip(defaults, args, strict=False)) | kwargs
            # Grids are coordinates of the dataset; of a part of a map they would be the part's.
            kept = {
                key: value for key, value in given.items() if key not in dataset.coords
            }
            dataset.attrs.update(origin(task.__name__, kept))
            return dataset

        return checked(run, units)

    return decorate


def origin(name: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes that record a call; ``tolerance`` is "round-off" where there is no ``tol``.

    Args:
        arguments: argument → value; of a dataset among them, the attributes are inherited.
    """
    model, method = _recorded_calls[name]
    options = {key: value for key, value in arguments.items() if key != "workers"}
    stated: dict[str, Any] = {"made_by": f"squealpipe.{name}"}
    inherited = ("parameters", "model", "method", "tolerance")
    for key, value in list(options.items()):
        if isinstance(value, Parameters):
            stated["parameters"] = _as_json(options.pop(key))
        elif hasattr(value, "as_dict"):  # a structure
            stated["parameters"] = json.dumps(options.pop(key).as_dict())
        elif isinstance(value, xr.Dataset):
            stated = {k: value.attrs[k] for k in inherited if k in value.attrs} | stated
            del options[key]
    stated["model"] = options.pop("model", model or stated.get("model", ""))
    stated["method"] = options.pop("method", method or stated.get("method", ""))
    stated["tolerance"] = options.pop("tol", stated.get("tolerance", "round-off"))
    stated["arguments"] = json.dumps(
        {key: plain(value) for key, value in options.items()}
    )
    return {**stated, **versions()}


@functools.lru_cache(maxsize=64)
def _as_json(parameters: Parameters) -> str:
    return json.dumps(parameters.as_dict())


def plain(value: Any) -> Any:
    """A value as JSON takes it; of a long array only first, last and number of values."""
    if isinstance(value, xr.Dataset):
        return {
            key: value.attrs[key]
            for key in ("curve", "parameters")
            if key in value.attrs
        }
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list) and any(isinstance(item, xr.Dataset) for item in value):
        return [plain(item) for item in value]
    if value is None or isinstance(value, str | int | float):
        return value
    array = np.asarray(value)
    # an argument with more values than this is recorded by first, last and number
    longest = 8
    if array.size > longest:
        values = array.ravel()
        return {
            "first": plain(values[0]),
            "last": plain(values[-1]),
            "number": array.size,
        }
    if array.dtype.kind == "f":
        array = array.astype(float)  # JSON knows no longer ones
    return array.tolist() if array.dtype.kind in "biufU" else str(value)
