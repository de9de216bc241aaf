"""Datasets as tables for other programs: CSV, MATLAB, Excel, Parquet."""

from __future__ import annotations  # help shows Angle, not its checks

import io
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from squealpipe.schema import meanings
from squealpipe.store.matlab import write_matlab
from squealpipe.store.vtu import write_vtu
from squealpipe.store.whole_files import whole_file
from squealpipe.validation import AnyPath, checked


@checked
def convert(dataset: xr.Dataset, path: AnyPath) -> list[Path]:
    """Write a dataset for another program: ``.csv``, ``.mat``, ``.xlsx``, ``.parquet``, ``.vtu``.

    Tables have one row for each point of the dimensions that most values are over, and flags in
    words. Variables over other dimensions go to further sheets or to files beside the first
    (``run.event.csv``). Units are in the header: in lines that begin with ``#`` of CSV, else with
    the names (``x [m]``). A MATLAB file holds the arrays as they are, flags as numbers, and the
    structures ``units``, ``meanings`` and ``attributes``; a name that MATLAB does not take is
    changed (``_x`` to ``x_``, ``θ`` to ``u3b8``), and ``names`` has the original ones. Mode shapes
    of a structure with a mesh go to ``.vtu``, for ParaView: ``mode_N_real``, ``mode_N_imaginary``
    and ``mode_N_amplitude`` at the nodes.

    Args:
        dataset: any dataset.
        path: file to write.

    Returns:
        The files, the main one first.

    Raises:
        ValueError: another ending, a table too long for Excel, or a library that is missing.
    """
    target = Path(path)
    if target.suffix == ".vtu":
        return [write_vtu(dataset, target)]
    # ending → the library of the extra ``export`` that writes it
    library_of_form = {
        ".csv": None,
        ".mat": None,
        ".xlsx": "openpyxl",
        ".parquet": "pyarrow",
    }
    if target.suffix not in library_of_form:
        raise ValueError(
            f"{target}: end the name in {', '.join(library_of_form)}, .vtu"
        )
    needed = library_of_form[target.suffix]
    if needed is not None and find_spec(needed) is None:
        raise ValueError(
            f"{target} needs {needed}; pip install 'squealpipe[export]', or {needed}"
        )
    if target.suffix == ".mat":
        with whole_file(target) as temporary:
            write_matlab(dataset, _about(dataset), temporary)
        return [target]
    if target.suffix == ".xlsx":
        return _write_sheets(dataset, target)
    files = []
    tables = _tables(dataset) or {(): _table_of_numbers(dataset)}
    for index, (dims, frame) in enumerate(tables.items()):
        files.append(
            target.with_suffix(f".{'_'.join(dims)}{target.suffix}") if index else target
        )
        with whole_file(files[-1]) as temporary:
            if target.suffix == ".csv":
                head = _head_of_csv(dataset, frame, target, with_numbers=not index)
                _write_csv(head, frame, temporary)
            else:
                frame.attrs = _about(dataset)
                frame.rename(columns=lambda name: _header(dataset, name)).to_parquet(
                    temporary
                )
    return files


def _tables(dataset: xr.Dataset) -> dict[tuple[str, ...], pd.DataFrame]:
    """One table for each set of dimensions, the one with most values first."""
    names: dict[tuple[str, ...], list[str]] = {}
    for name, variable in dataset.data_vars.items():
        if variable.ndim:
            names.setdefault(tuple(map(str, variable.dims)), []).append(str(name))
    biggest = sorted(
        names, key=lambda dims: -sum(dataset[name].size for name in names[dims])
    )
    return {
        dims: xr.Dataset({name: _words(dataset[name]) for name in names[dims]})
        .to_dataframe(dim_order=list(dims))[names[dims]]
        .reset_index()
        for dims in biggest
    }


def _head_of_csv(
    dataset: xr.Dataset, frame: pd.DataFrame, target: Path, *, with_numbers: bool
) -> list[str]:
    columns = ", ".join(_header(dataset, name) for name in frame.columns)
    about = _about(dataset)
    head = [f"# {about.pop('title', target.stem)}", f"# columns: {columns}"]
    if with_numbers:
        head += [f"# {name} = {value}" for name, value in _numbers(dataset).items()]
    return [
        *head,
        *(f"# {key}: {' '.join(text.split())}" for key, text in about.items()),
    ]


def _write_csv(head: list[str], frame: pd.DataFrame, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write("\n".join(head) + "\n")
        frame.to_csv(file, index=False)


def _write_sheets(dataset: xr.Dataset, path: Path) -> list[Path]:
    tables = _tables(dataset)
    about = {**_numbers(dataset), **_about(dataset)}
    # a full disk in the middle of a zip file ends in a traceback
    content = io.BytesIO()
    with pd.ExcelWriter(content, engine="openpyxl") as book:
        sheets: set[str] = set()
        for dims, frame in tables.items():
            sheet = _sheet_name("_".join(dims), sheets | {"about"})
            sheets.add(sheet)
            _plain_text(
                frame.rename(columns=lambda name: _header(dataset, name))
            ).to_excel(book, sheet_name=sheet, index=False)
        _plain_text(pd.Series(about, name="value").to_frame()).to_excel(
            book, sheet_name="about", index_label="name"
        )
        for sheet in book.book.worksheets:
            for row in sheet.iter_rows():
                for cell in row:
                    if cell.data_type == "f":  # a text that begins with =, no formula
                        cell.data_type = "s"
    with whole_file(path) as temporary:
        temporary.write_bytes(content.getvalue())
    return [path]


def _plain_text(frame: pd.DataFrame) -> pd.DataFrame:
    """The table without control characters in its texts, which no sheet takes."""
    # Excel refuses them
    control_characters = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f]")
    return frame.map(
        lambda value: (
            control_characters.sub("?", value) if isinstance(value, str) else value
        )
    ).rename(columns=lambda name: control_characters.sub("?", str(name)))


def _sheet_name(name: str, taken: set[str]) -> str:
    """A name that Excel takes, and that no other sheet has: it compares without case."""
    short = re.sub(r"[\[\]:*?/\\]", "_", name)[:31].strip("'") or "sheet"
    number, free = 1, short
    while free.lower() in {other.lower() for other in taken}:
        number += 1
        free = f"{short[: 30 - len(str(number))]}_{number}"
    return free


def _table_of_numbers(dataset: xr.Dataset) -> pd.DataFrame:
    """The table of a dataset that has single numbers alone: one row."""
    numbers = {
        str(name): [_words(variable).item()]
        for name, variable in dataset.data_vars.items()
        if not variable.ndim
    }
    return pd.DataFrame(numbers)


def _numbers(dataset: xr.Dataset) -> dict[str, str]:
    """The variables that are single numbers, with their units."""
    return {
        str(name): f"{_words(variable).item()}{_unit(variable)}"
        for name, variable in dataset.data_vars.items()
        if not variable.ndim
    }


def _about(dataset: xr.Dataset) -> dict[str, str]:
    # attributes of a dataset that go with its tables
    return {
        str(key): str(dataset.attrs[key])
        for key in (
            "title",
            "config",
            "parameters",
            "system",
            "package_version",
            "commit",
        )
        if key in dataset.attrs
    }


def _words(variable: xr.DataArray) -> xr.DataArray:
    """Flags as their meanings; other values as they are."""
    table = meanings(variable)
    if not table:
        return variable
    words = np.array(
        [table[code] for code in np.ravel(variable.values).tolist()], dtype=object
    )
    return variable.copy(data=words.reshape(variable.shape))


def _header(dataset: xr.Dataset, name: str) -> str:
    return f"{name}{_unit(dataset[name])}" if name in dataset else name


def _unit(variable: xr.DataArray) -> str:
    unit = str(variable.attrs.get("units", "1"))
    return "" if unit == "1" else f" [{unit}]"
