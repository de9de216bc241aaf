"""Datasets as tables for other programs: CSV, MATLAB, Excel, Parquet."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from squealpipe.schema import meanings
from squealpipe.store.whole_files import whole_file
from squealpipe.validation import AnyPath, checked

NEEDS = {".csv": None, ".mat": None, ".xlsx": "openpyxl", ".parquet": "pyarrow"}
"""Form → the library of the extra ``export`` that writes it."""
RECORDED = ("title", "config", "parameters", "system", "package_version", "commit")
"""Attributes of a dataset that go with its tables."""


@checked
def convert(dataset: xr.Dataset, path: AnyPath) -> list[Path]:
    """Write a dataset for another program: ``.csv``, ``.mat``, ``.xlsx`` or ``.parquet``.

    Tables have one row for each point of the dimensions that most values are over, and flags in
    words. Variables over other dimensions go to further sheets or to files beside the first
    (``run.event.csv``). Units are in the header: in lines that begin with ``#`` of CSV, else with
    the names (``x [m]``). A MATLAB file holds the arrays as they are, flags as numbers, and the
    structures ``units``, ``meanings`` and ``attributes``.

    Args:
        dataset: any dataset of this package.
        path: file to write.

    Returns:
        The files, the main one first.

    Raises:
        ValueError: another ending, a table too long for Excel, or a library that is missing.
    """
    target = Path(path)
    if target.suffix not in NEEDS:
        raise ValueError(f"{target}: end the name in {', '.join(NEEDS)}")
    needed = NEEDS[target.suffix]
    if needed is not None and find_spec(needed) is None:
        raise ValueError(
            f"{target} needs {needed}; pip install 'squealpipe[export]', or {needed}"
        )
    if target.suffix == ".mat":
        return _write_matlab(dataset, target)
    if target.suffix == ".xlsx":
        return _write_sheets(dataset, target)
    files = []
    for place, (dims, frame) in enumerate(_tables(dataset).items()):
        files.append(
            target.with_suffix(f".{'_'.join(dims)}{target.suffix}") if place else target
        )
        with whole_file(files[-1]) as temporary:
            if target.suffix == ".csv":
                _write_csv(dataset, frame, temporary, with_numbers=not place)
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


def _write_csv(
    dataset: xr.Dataset, frame: pd.DataFrame, path: Path, *, with_numbers: bool
) -> None:
    columns = ", ".join(_header(dataset, name) for name in frame.columns)
    about = _about(dataset)
    head = [f"# {about.pop('title')}", f"# columns: {columns}"]
    if with_numbers:
        head += [f"# {name} = {value}" for name, value in _numbers(dataset).items()]
    head += [f"# {key}: {' '.join(text.split())}" for key, text in about.items()]
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write("\n".join(head) + "\n")
        frame.to_csv(file, index=False)


def _write_sheets(dataset: xr.Dataset, path: Path) -> list[Path]:
    tables = _tables(dataset)
    about = {**_numbers(dataset), **_about(dataset)}
    with (
        whole_file(path) as temporary,
        pd.ExcelWriter(temporary, engine="openpyxl") as book,
    ):
        for dims, frame in tables.items():
            frame.rename(columns=lambda name: _header(dataset, name)).to_excel(
                book, sheet_name="_".join(dims)[:31], index=False
            )
        pd.Series(about, name="value").to_excel(
            book, sheet_name="about", index_label="name"
        )
    return [path]


def _write_matlab(dataset: xr.Dataset, path: Path) -> list[Path]:
    from scipy.io import savemat

    variables = {str(name): variable for name, variable in dataset.variables.items()}
    content: dict[str, object] = {
        name: variable.values.astype(object)
        if variable.dtype.kind in "UO"
        else variable.values
        for name, variable in variables.items()
    }
    content["units"] = {
        name: given.attrs["units"]
        for name, given in variables.items()
        if "units" in given.attrs
    }
    content["meanings"] = {
        name: ", ".join(f"{value}: {words}" for value, words in table.items())
        for name in variables
        if (table := meanings(dataset[name]))
    }
    content["attributes"] = _about(dataset)
    with whole_file(path) as temporary:
        savemat(
            temporary, content, appendmat=False, long_field_names=True, oned_as="column"
        )
    return [path]


def _numbers(dataset: xr.Dataset) -> dict[str, str]:
    """The variables that are single numbers, with their units."""
    return {
        str(name): f"{_words(variable).item()}{_unit(variable)}"
        for name, variable in dataset.data_vars.items()
        if not variable.ndim
    }


def _about(dataset: xr.Dataset) -> dict[str, str]:
    return {
        str(key): str(dataset.attrs[key]) for key in RECORDED if key in dataset.attrs
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
