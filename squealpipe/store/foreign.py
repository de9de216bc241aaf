"""Files of other programs: NetCDF and CSV that are drawn and converted as far as they can be."""

import os
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from squealpipe.laws.numerals import decimal_sign, numeral
from squealpipe.laws.rows import text_rows
from squealpipe.store.netcdf import ERRORS_OF_DAMAGED_FILES, load, with_plain_texts
from squealpipe.store.sealed import SEAL_MARK
from squealpipe.store.whole_files import StoreError


def load_any(path: str | os.PathLike[str]) -> xr.Dataset:
    """A dataset of this package, checked, or the content of another program's NetCDF or CSV file.

    Raises:
        FileNotFoundError: no such file.
        StoreError: it was damaged, or is neither.
    """
    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"no file {source}; check the path")
    if source.suffix == ".csv":
        return _table(source)
    if SEAL_MARK in source.read_bytes()[-200:]:
        return load(source)
    try:
        with xr.open_dataset(source, engine="netcdf4", decode_times=False) as opened:
            foreign = "dataset_id" not in opened.attrs
            dataset = opened.load() if foreign else opened
    except ERRORS_OF_DAMAGED_FILES as error:
        raise StoreError(
            f"{source} cannot be read as NetCDF ({error}); a file that ends in .nc must be NetCDF, "
            "one that ends in .csv a table of texts"
        ) from error
    if not foreign:  # ours, but without its last line
        return load(source)
    return with_plain_texts(dataset)


def _table(path: Path) -> xr.Dataset:
    """The columns of a table over its first one, or over its rows where that repeats values."""
    try:
        frame = pd.read_csv(path, comment="#", skipinitialspace=True, **_form(path))
    except ValueError as error:  # as which pandas reports what is no table
        raise StoreError(
            f"{path} is no table of columns with a name in the first line ({error})"
        ) from error
    if frame.empty:
        raise StoreError(f"{path} has no rows below its names")
    frame.columns = [str(name).strip() for name in frame.columns]
    first = frame.columns[0]
    along = frame[first]
    if len(frame.columns) > 1 and along.is_unique and along.dtype.kind in "fiu":
        frame = frame.set_index(first)
    else:
        frame.index.name = "row"
    return with_plain_texts(xr.Dataset.from_dataframe(frame))


def _form(path: Path) -> dict[str, Any]:
    """Return pandas' options for a table: separator, decimal sign, row of the names.

    Raises:
        ValueError: a comma of some number is decimal or separates thousands.
    """
    table = text_rows(path, is_header=lambda _: False)  # comments are left out
    above = table.rows[0].number - 1 if table.rows else 0
    if table.separator == ",":
        return {"skiprows": above}
    numbers = [
        (f"row {row}", number.text)
        for row, cells in table.rows
        for cell in cells
        if (number := numeral(cell)) is not None
    ]
    comma = decimal_sign(numbers, table.separator) == "comma"
    decimal = "," if comma else "."
    if table.separator != " " or not table.rows:
        return {"sep": table.separator, "decimal": decimal, "skiprows": above}
    # names may have single blanks in them: time (s)  force (N)
    return {
        "sep": r"\s+",
        "decimal": decimal,
        "header": None,
        "names": table.rows[0].cells,
        "skiprows": above + 1,
    }
