"""The gate for arguments: annotations say what a function takes; all else is refused by name."""

import functools
import inspect
import keyword
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ParamSpec, TypeVar, cast

import numpy as np
from annotated_types import Ge, Gt, Interval
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    ValidationError,
    WrapValidator,
    validate_call,
)

from squealpipe.systems.inputs.units import refuse_units
from squealpipe.systems.inputs.values import brief, is_whole_number, numbers_in_si
from squealpipe.systems.inputs.words import in_words, suggestion
from squealpipe.systems.one_thread import one_thread

Given = ParamSpec("Given")
Result = TypeVar("Result")


Arguments = tuple[list[Any], dict[str, Any]]


def options_in_si(
    names: Sequence[str], args: Sequence[Any], kwargs: Mapping[str, Any]
) -> Arguments:
    """Return arguments, with texts and quantities of options that have a unit as numbers in SI.

    Raises:
        ValueError: a quantity of another kind; names the argument.
    """
    known = dict(zip(names, args, strict=False)) | dict(kwargs)
    # CF units of the options of all systems, whose values may be texts with a unit
    units_of_arguments = {
        **dict.fromkeys(
            ("t_start", "t_end", "t_late", "t_settle", "times", "last"), "s"
        ),
        **dict.fromkeys(("tol", "smoothed_tol"), "1"),
    }
    read = {
        name: numbers_in_si(name, value, units_of_arguments[name])
        if name in units_of_arguments and value is not None
        else value
        for name, value in known.items()
    }
    positional = [read.pop(name) for name in names[: len(args)]]
    return [*positional, *args[len(positional) :]], read


def checked(
    function: Callable[Given, Result],
    read: Callable[
        [Sequence[str], Sequence[Any], Mapping[str, Any]], Arguments
    ] = options_in_si,
) -> Callable[Given, Result]:
    """Have a function check and convert its arguments by their annotations.

    Args:
        read: turns texts with units into numbers, from the names of the function's arguments and
            a call's arguments.

    Raises:
        ValueError: an argument that is not allowed; names it, its value and what is needed.
        TypeError: an argument is missing, unknown or given twice.
    """
    names = list(inspect.signature(function).parameters)
    config = ConfigDict(arbitrary_types_allowed=True, strict=True)
    call = validate_call(config=config)(function)

    @functools.wraps(function)
    def run(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        positional, named = read(names, args, kwargs)
        try:
            # our matrices are small or sparse: more threads only wait for one another
            with one_thread():
                return call(*positional, **named)
        except ValidationError as error:
            if error.title not in (function.__name__, function.__qualname__):
                raise
            title = function.__qualname__.removesuffix(".__init__")
            raise _refusal(error, title, names) from None

    return cast("Callable[Given, Result]", run)


def _refusal(error: ValidationError, title: str, names: list[str]) -> Exception:
    faults = error.errors(include_url=False)
    first = next(
        (fault for fault in faults if "unexpected" in fault["type"]), faults[0]
    )
    place, *inside = first["loc"]
    name = names[place] if isinstance(place, int) and place < len(names) else place
    if "argument" in first["type"]:
        near = (
            f"; {suggestion(name, names)}"
            if first["type"].startswith("unexpected")
            else ""
        )
        return TypeError(f"{title}: {name}: {first['msg'].lower()}{near}")
    where = "".join(f"[{step!r}]" for step in inside if step != "[key]")
    return ValueError(f"{name}{where} = {brief(first['input'])}: {in_words(first)}")


def real_array(name: str, values: Any, *, infinite: bool = False) -> np.ndarray:
    """A float array.

    Raises:
        ValueError: no real numbers, masked entries, NaN or (unless allowed) infinity, with the
            name and the first culprit.
    """
    # most often, and most runs
    if isinstance(values, float) and abs(values) <= (
        math.inf if infinite else sys.float_info.max
    ):
        return np.array(values)
    try:
        return reals(values, infinite=infinite)
    except ValueError as error:
        raise ValueError(f"{name} = {brief(values)}: {error}") from None


def reals(values: Any, *, infinite: bool = False) -> np.ndarray:
    """Return the float array of real numbers.

    Raises:
        ValueError: what :func:`real_array` refuses, without the name.
    """
    refuse_units(values)
    if np.ma.is_masked(values):
        raise ValueError("masked entries: fill them or leave them out")
    try:
        array = np.asarray(values)
    except (ValueError, TypeError, OverflowError) as error:
        raise ValueError("rows of one length are needed") from error
    # what people give instead of numbers, by NumPy's letter for the type
    kinds = {
        "U": "text",
        "S": "bytes",
        "b": "truth values",
        "c": "complex numbers",
        "M": "dates",
        "m": "durations",
    }
    if array.dtype.kind not in "fiu":
        raise ValueError(
            f"numbers are needed, not {kinds.get(array.dtype.kind, 'objects')}"
        )
    array = array.astype(float)
    bad = np.isnan(array) if infinite else ~np.isfinite(array)
    if bad.any():
        raise ValueError(
            f"finite numbers are needed, not {float(array[bad].flat[0])!r}"
        )
    return array


def _no_truth(value: Any) -> Any:
    if isinstance(value, np.bool_):  # which has a float, so that it passes for one
        raise ValueError("a number is needed, not a truth value")  # noqa: TRY004
    return value


def _number(value: Any) -> float:
    if type(value) is float and math.isfinite(value):
        return value
    array = reals(value)
    if array.ndim:
        raise ValueError("one number is needed")
    return float(array)


def _whole(value: Any) -> int:
    if not is_whole_number(value):
        raise ValueError("a whole number is needed")
    return int(value)


def _vector(value: Any) -> np.ndarray:
    array = np.atleast_1d(reals(value))
    if array.ndim != 1 or not array.size:
        raise ValueError(f"has shape {array.shape}: a 1-D array is needed")
    return array


def _line(value: Any) -> np.ndarray:
    array = reals(value)
    return array if not array.ndim else _vector(array)


def _not_negative(values: Any) -> Any:
    if (values < 0).any():
        raise ValueError("numbers of 0 or greater are needed")
    return values


def _path(value: Any) -> Path:
    if not isinstance(value, str | os.PathLike) or "\0" in os.fspath(value):
        raise ValueError("a path is needed")
    try:
        return Path(value).expanduser()  # a shell would have replaced ~
    except RuntimeError as error:
        raise ValueError("no home folder is known for it; write the folder") from error


def _values(value: Any) -> Any:
    if hasattr(value, "data_vars"):  # importing xarray takes longer than most commands
        raise ValueError("names and values are needed, not a dataset")
    return value


def _identifier(value: str) -> str:
    if not value.isidentifier() or keyword.iskeyword(value):
        raise ValueError(
            "letters, digits and _ are needed, as for a variable of Python"
        )
    return value


def _word(value: str) -> str:
    if not value.strip() or not value.isprintable() or "/" in value:
        raise ValueError("a name without / is needed")
    return value


def needed(what: str) -> WrapValidator:
    """Words for what a type with several forms allows."""

    def check(value: Any, handler: Callable[[Any], Any]) -> Any:
        try:
            return handler(value)
        except ValidationError:
            raise ValueError(f"{what} needed") from None

    return WrapValidator(check)


def one_of(names: Iterable[str]) -> BeforeValidator:
    """One of some words."""
    known = tuple(names)

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in known:
            raise ValueError(f"unknown; {suggestion(value, known)}")
        return value

    return BeforeValidator(check)


Number = Annotated[float, BeforeValidator(_number)]
"""A finite number, also of an array without dimensions."""
Positive = Annotated[Number, Gt(0)]
NotNegative = Annotated[Number, Ge(0)]
Tolerance = Annotated[Number, Interval(gt=1e-18, lt=1e-2)]
"""Tolerance of the Taylor integrator, over the sizes of the states."""
Extended = Annotated[float, BeforeValidator(_no_truth)]
"""A number that may be infinite."""
Whole = Annotated[int, BeforeValidator(_whole)]
Natural = Annotated[Whole, Ge(1)]
Several = Annotated[Whole, Ge(2)]
Workers = Natural | None
"""Processes; None takes all cores."""
Seed = Annotated[Whole, Ge(0)]
Vector = Annotated[Any, BeforeValidator(_vector)]
"""A 1-D array of finite numbers; one number is an array of one."""
NotNegativeVector = Annotated[Vector, AfterValidator(_not_negative)]
Line = Annotated[Any, BeforeValidator(_line)]
"""A number, or a 1-D array of them."""
Values = Annotated[Mapping[str, Any], BeforeValidator(_values)]
"""Names → values; each is checked where its name is known."""
Identifier = Annotated[str, AfterValidator(_identifier)]
"""A name that is used as an attribute or a keyword."""
Word = Annotated[str, AfterValidator(_word)]
"""A name that becomes part of the names of variables."""
AnyPath = Annotated[Any, BeforeValidator(_path)]
