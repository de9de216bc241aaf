"""Datasets as CSV tables, for spreadsheets: one table for each set of dimensions."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import xarray as xr

from squealpipe.schema import meanings
from squealpipe.store.whole_files import whole_file


def write_csv(dataset: xr.Dataset, path: str | os.PathLike[str]) -> list[Path]:
    """Write a dataset as text; flags are written as words.

    The variables over those dimensions that have most values go to ``path``, the others beside it
    (``run.event.csv``). Lines that begin with ``#`` hold the title, the units and what is a single
    number.

    Args:
        dataset: a dataset that fits its schema.
        path: file that ends in ``.csv``.

    Returns:
        The files, the main one first.
    """
    target = Path(path)
    tables: dict[tuple[str, ...], list[str]] = {}
    single = []
    for name, variable in dataset.data_vars.items():
        if variable.ndim:
            tables.setdefault(tuple(map(str, variable.dims)), []).append(str(name))
        else:
            single.append(f"# {name} = {_words(variable).item()}{_unit(variable)}")
    biggest = sorted(
        tables, key=lambda dims: sum(dataset[name].size for name in tables[dims]), reverse=True
    )
    files = []
    for place, dims in enumerate(biggest):
        beside = target.with_suffix(f".{'_'.join(dims)}.csv")
        files.append(target if place == 0 else beside)
        _write_table(dataset, dims, tables[dims], files[-1], single if place == 0 else [])
    return files


def _write_table(
    dataset: xr.Dataset, dims: tuple[str, ...], names: list[str], path: Path, single: list[str]
) -> None:
    frame = xr.Dataset({name: _words(dataset[name]) for name in names}).to_dataframe(
        dim_order=list(dims)
    )
    columns = [f"{name}{_unit(dataset[name])}" for name in [*dims, *names] if name in dataset]
    head = [f"# {dataset.attrs['title']}", f"# columns: {', '.join(columns)}", *single]
    head += [
        f"# {key}: {' '.join(str(dataset.attrs[key]).split())}"
        for key in ("config", "package_version", "commit")
        if key in dataset.attrs
    ]
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        file.write("\n".join(head) + "\n")
        frame[names].reset_index().to_csv(file, index=False)


def _words(variable: xr.DataArray) -> xr.DataArray:
    """Flags as their meanings; other values as they are."""
    table = meanings(variable)
    if not table:
        return variable
    words = np.array([table[code] for code in np.ravel(variable.values).tolist()], dtype=object)
    return variable.copy(data=words.reshape(variable.shape))


def _unit(variable: xr.DataArray) -> str:
    unit = str(variable.attrs.get("units", "1"))
    return "" if unit == "1" else f" [{unit}]"
