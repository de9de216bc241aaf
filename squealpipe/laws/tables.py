"""Laws of the user's own: values between the knots of a table, or the source of a Python file.

``linear 0:0.5 0.1:0.4 1:0.3`` holds pairs of knot and value, ``cubic …`` the same, joined by the
monotone cubics of Fritsch and Carlson. The content is the law: it stands in parameters, keys and
datasets as the name of a formula does, so nothing depends on a file that was read once. A value is
found by bisection among the knots; it is constant before the first one.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

from squealpipe.laws.headers import COLUMN_UNITS
from squealpipe.laws.one_file import without_neighbours
from squealpipe.laws.table_files import ENDINGS, read_pairs
from squealpipe.systems.inputs.values import numbers_in_si
from squealpipe.systems.inputs.words import as_number

BETWEEN = ("linear", "cubic")


class OwnLawRules(NamedTuple):
    """Rules that a package of laws sets for laws of the user's own.

    Attributes:
        columns: names of a table's columns, (abscissa, value).
        units: units of these columns.
        files: kinds of files that are read, in the words of an error.
        refused: names of laws that are refused, with the reason.
        in_table: names of the parameters that a table replaces.
        in_source: names of those that a Python file replaces.
    """

    columns: tuple[str, str]
    units: tuple[str, str]
    files: str
    refused: Mapping[str, str]
    in_table: tuple[str, ...]
    in_source: tuple[str, ...]


class Pieces(NamedTuple):
    """A piecewise polynomial.

    Attributes:
        starts: (pieces,) where each begins; the last has no end.
        coefficients: (pieces, 4) of the powers 0 to 3 of the distance from there.
    """

    starts: Any
    coefficients: Any

    def value(self, at: Any, *, derivative: bool = False) -> Any:
        """Return the value at a float or an array, or the derivative there.

        The piece is chosen by the real part, so that complex steps give derivatives. A knot belongs
        to the piece that begins there.
        """
        import numpy as np

        after = np.searchsorted(self.starts, np.real(at), side="right")
        piece = np.maximum(after - 1, 0)
        rows = self.coefficients.T[:, piece]
        return polynomial(rows, at - self.starts[piece], derivative)

    def constants(self, prefix: str) -> list[dict[str, float]]:
        """Return start, end and coefficients of each piece by name.

        The last piece has no end; its start stands in that place.
        """
        ends = [*self.starts[1:], self.starts[-1]]
        names = [
            f"{prefix}_{what}" for what in ("start", "end", "c0", "c1", "c2", "c3")
        ]
        rows = zip(self.starts, ends, self.coefficients, strict=True)
        return [
            dict(zip(names, map(float, (start, end, *each)), strict=True))
            for start, end, each in rows
        ]


def polynomial(coefficients: Any, distance: Any, derivative: bool = False) -> Any:
    """Return c0 + c1 d + c2 d² + c3 d³, or its derivative by the distance d."""
    c0, c1, c2, c3 = coefficients
    if derivative:
        return c1 + distance * (2.0 * c2 + distance * (3.0 * c3))
    return c0 + distance * (c1 + distance * (c2 + distance * c3))


def read_table(
    path: str | PathLike[str],
    columns: tuple[str, str],
    between: str = "linear",
    chosen: tuple[str | None, str | None] = (None, None),
) -> str:
    """Return the text of a table that a file holds (:mod:`squealpipe.laws.table_files`), in SI.

    Args:
        columns: names of the columns of knots and values; where there are only two columns, that of
            values may have any name.
        chosen: names of the columns to take instead.
    """
    if between not in BETWEEN:
        raise ValueError(f"between = {between!r}: choose from {', '.join(BETWEEN)}")
    pairs = read_pairs(path, columns, chosen)
    return between + "".join(f" {knot!r}:{value!r}" for knot, value in pairs)


@lru_cache(maxsize=64)
def knots_of(text: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the knots, ascending, and the values of the text of a table.

    Raises:
        ValueError: it is no table, has a negative or infinite number, or does not ascend.
    """
    try:
        pairs = [tuple(map(as_number, pair.split(":"))) for pair in text.split()[1:]]
        knots, values = (tuple(each) for each in zip(*pairs, strict=True))
    except ValueError:
        raise ValueError(
            "a table is written like 'linear 0:0.5 0.1:0.4 1:0.3'"
        ) from None
    for number in (*knots, *values):
        if not (math.isfinite(number) and number >= 0):
            raise ValueError(
                f"{number!r} in the table: finite numbers from 0 on are needed"
            )
    for before, after in pairwise(knots):
        if not before < after:
            raise ValueError(
                f"{after!r} stands after {before!r} in the table: it must ascend, with one value "
                "for each"
            )
    return knots, values


def scaled(text: str, knot: float, value: float) -> str:
    """Return the text of a table with its knots, and its values, divided by a unit."""
    pairs = zip(*knots_of(text), strict=True)
    return text.split(maxsplit=1)[0] + "".join(
        f" {k / knot!r}:{v / value!r}" for k, v in pairs
    )


def functions_of(source: str) -> dict[str, Any]:
    """Run the source of a law in Python, and return what it defines."""
    namespace: dict[str, Any] = {}
    try:
        with without_neighbours():
            exec(compile(source, "<law>", "exec"), namespace)  # noqa: S102 (the user's own file)
    except SyntaxError as error:
        raise ValueError(
            f"line {error.lineno} of the law is not Python: {error.msg}"
        ) from error
    return namespace


def is_table(name: object) -> bool:
    """Return whether the name of a law is the text of a table."""
    return isinstance(name, str) and name.partition(" ")[0] in BETWEEN and ":" in name


def stood_for(law: Any, laws: Any) -> tuple[str, ...]:
    """Return the names of the parameters that a law of the user's own replaces."""
    if is_table(law):
        return tuple(laws.own_law_rules.in_table)
    return tuple(laws.own_law_rules.in_source) if "\n" in str(law) else ()


@lru_cache(maxsize=64)
def pieces_of(text: str, *, goes_on: bool = False) -> Pieces:
    """Return the pieces of a table from 0 on, constant before the first knot.

    Args:
        goes_on: whether it goes on beyond the last knot with the slope there; else it is constant.
    """
    import numpy as np

    knots, values = (np.array(each) for each in knots_of(text))
    if text.startswith("cubic") and len(knots) > 2:
        from scipy.interpolate import PchipInterpolator

        inner = PchipInterpolator(knots, values).c[::-1].T
    else:
        slopes = np.diff(values) / np.diff(knots)
        inner = np.stack([values[:-1], slopes, 0 * slopes, 0 * slopes], axis=-1)
    slope = 0.0
    if goes_on and len(inner):
        slope = polynomial(inner[-1], knots[-1] - knots[-2], derivative=True)
    last = [values[-1], slope, 0.0, 0.0]
    coefficients = np.vstack([inner.reshape(-1, 4), last])
    if knots[0] > 0:
        knots = np.append(0.0, knots)
        coefficients = np.vstack([[values[0], 0.0, 0.0, 0.0], coefficients])
    return Pieces(knots, coefficients)


def _listed(given: Mapping[str, Any], columns: tuple[str, str]) -> str:
    """Return the text of a table from lists of its knots and values."""
    if not set(columns) <= set(given) <= {*columns, "between"}:
        raise ValueError(
            f"write both lists, {columns[0]} and {columns[1]}, and if wanted `between: cubic`"
        )
    lists = []
    for column in columns:
        values = given[column]
        if isinstance(values, str) or not hasattr(values, "__len__"):
            raise ValueError(f"{column} = {values!r}: a list of numbers is needed")
        numbers = numbers_in_si(column, list(values), COLUMN_UNITS[column])
        lists.append([float(number) for number in numbers])
    if len({len(values) for values in lists}) > 1:
        sizes = " and ".join(str(len(values)) for values in lists)
        raise ValueError(
            f"{columns[0]} and {columns[1]} have {sizes} values: as many are needed"
        )
    between = given.get("between", "linear")
    if between not in BETWEEN:
        raise ValueError(f"between = {between!r}: choose from {', '.join(BETWEEN)}")
    pairs = zip(*lists, strict=True)
    return str(between) + "".join(f" {knot!r}:{value!r}" for knot, value in pairs)


def named(given: Any, columns: tuple[str, str], folder: Path = Path()) -> Any:
    """Return the name of a law from what a user writes: a file becomes its content.

    Args:
        given: a name; the path of a table or Python file; or ``{"table": path, "between":
            "cubic", "speed_column": name, "value_column": name}``, ``{"python": path}``, or both
            columns as lists, of numbers in SI or texts with units.
    """
    if isinstance(given, PathLike) or (
        isinstance(given, str) and given.lower().endswith((*ENDINGS, ".py"))
    ):
        given = {"python" if fspath(given).endswith(".py") else "table": fspath(given)}
    if not isinstance(given, Mapping):
        return given
    if set(given) & set(columns):
        return _listed(given, columns)
    for key in {"table", "python"} & set(given):
        if not isinstance(given[key], str | PathLike):
            raise ValueError(  # noqa: TRY004 (of a file, where all mistakes are values)
                f"{key} = {given[key]!r}: write the name of a file"
            )
    if set(given) == {"python"}:
        return (folder / Path(given["python"]).expanduser()).read_text(encoding="utf-8")
    options = (f"{columns[0]}_column", "value_column")
    if not {"table"} <= set(given) <= {"table", "between", *options}:
        raise ValueError(
            f"write {{table: FILE.csv}} or {{{columns[0]}: […], {columns[1]}: […]}}, "
            "if wanted with `between: cubic`, "
            f"`{options[0]}:` and `{options[1]}:`, or {{python: FILE.py}}"
        )
    first, second = (given.get(option) for option in options)
    between = given.get("between", "linear")
    return read_table(
        folder / Path(given["table"]).expanduser(), columns, between, (first, second)
    )
