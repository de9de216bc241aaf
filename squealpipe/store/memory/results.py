"""A whole run as one tree of datasets, opened without reading the values."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from squealpipe.schema import DatasetSchema, find
from squealpipe.schema.sweep import fill_up
from squealpipe.store.comparison.compare import configuration
from squealpipe.store.comparison.matching import on_shared_points
from squealpipe.store.header import dataset_from
from squealpipe.store.netcdf import StoreError, load
from squealpipe.store.runs import dataset_files, locate
from squealpipe.store.seal import Seal, read_seal
from squealpipe.validation import checked

RUN = "run"

Place = str | os.PathLike[str]


@checked
def open_results(
    name_or_path: Place | Sequence[Place], *, along: str | None = None, root: Place = "."
) -> xr.DataTree:
    """The datasets of a run as a tree: one node each, by their names below ``data/``.

    Values are read when they are used; every file is held against its checksum when it is opened.

    Args:
        name_or_path: an archive by its name, or a folder of results; with ``along`` a list.
        along: "run" stacks each dataset that all runs have along a new dimension ``run``, whose
            coordinates are the runs' names and every parameter that differs. Grids are cut to the
            points that all share; shorter lists are filled up as in a sweep. The values are read.
        root: the checkout, where archives are looked up by name.

    Returns:
        The tree; ``tree["stability_map"]`` and ``tree["backbone/F10_mode1"]`` are its nodes.

    Raises:
        FileNotFoundError: no such archive or folder.
        StoreError: a file is damaged, or no dataset of this package.
        ValueError: a list without ``along``, fewer than one run, or runs that share no dataset.
    """
    if isinstance(name_or_path, str | os.PathLike):
        if along is not None:
            raise ValueError(f"along={along!r} stacks several runs; give a list of them")
        place = locate(name_or_path, root)
        files = dataset_files(place)
        return xr.DataTree.from_dict(
            {name: open_lazily(path) for name, path in files.items()}, name=place.name
        )
    if along != RUN or not name_or_path:
        raise ValueError(
            f"name_or_path = {name_or_path!r}, along = {along!r}: give one run, or a list of runs "
            "and along='run'"
        )
    runs = {str(item): dataset_files(locate(item, root)) for item in name_or_path}
    if len(runs) < len(name_or_path):
        raise ValueError("a run is named twice; name each once")
    shared = [
        name for name in next(iter(runs.values())) if all(name in run for run in runs.values())
    ]
    if not shared:
        raise ValueError(f"{', '.join(runs)} share no dataset of one name")
    return xr.DataTree.from_dict(
        {name: stacked({run: load(files[name]) for run, files in runs.items()}) for name in shared}
    )


def open_lazily(path: Path) -> xr.Dataset:
    """A dataset whose values are read when they are used; coordinates of grids are read now.

    Raises:
        StoreError: the file is not as it was written, or cannot be opened.
    """
    seal, header = read_seal(path)
    if seal in {Seal.broken, Seal.unreadable}:
        raise StoreError(f"{path} was changed or damaged since it was made; make it again")
    made = dataset_from(header, lambda *of: indexing.LazilyIndexedArray(_StoredArray(path, *of)))
    if made is not None:
        return made
    try:
        with netCDF4.Dataset(path) as file:
            variables = {name: _lazy(path, name, file[name]) for name in file.variables}
            attrs = {name: file.getncattr(name) for name in file.ncattrs()}
    except (OSError, RuntimeError) as error:
        raise StoreError(f"{path} cannot be opened as NetCDF-4 ({error})") from error
    if "schema" not in attrs:
        raise StoreError(f"{path} was not written by squealpipe: it has no `schema` attribute")
    coords = {name for name in find(str(attrs["schema"])).coordinates if name in variables}
    data = {name: variable for name, variable in variables.items() if name not in coords}
    return xr.Dataset(data, {name: variables[name] for name in coords}, attrs)


def _lazy(path: Path, name: str, variable: Any) -> xr.Variable:
    attrs = dict(variable.__dict__)
    truth = attrs.pop("dtype", "") == "bool"  # how Xarray marks what NetCDF has no type for
    if variable.dimensions == (name,):
        values = _text(variable[...])
        return xr.Variable((name,), values.astype(bool) if truth else values, attrs)
    stored = np.dtype(object) if variable.dtype is str else np.dtype(variable.dtype)
    array = _StoredArray(path, name, variable.shape, np.dtype(bool) if truth else stored)
    lazy = indexing.LazilyIndexedArray(array)
    return xr.Variable(variable.dimensions, lazy, attrs, fastpath=True)


def _text(values: Any) -> np.ndarray:
    array = np.ma.getdata(values)
    return array.astype(str) if array.dtype.kind == "O" else array


class _StoredArray(BackendArray):
    """A variable in a file that is opened for each access, so no tree holds files open."""

    def __init__(self, path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype) -> None:
        self.path, self.name, self.shape, self.dtype = path, name, shape, dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(
            key, self.shape, indexing.IndexingSupport.OUTER, self._read
        )

    def _read(self, key: tuple) -> np.ndarray:
        with netCDF4.Dataset(self.path) as file:
            variable = file[self.name]
            variable.set_auto_maskandscale(False)
            values = _text(variable[key] if key else variable[...])
        return values.astype(bool) if self.dtype == bool else values


def stacked(datasets: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Datasets of one schema along ``run``; changed parameters become coordinates of it.

    Raises:
        ValueError: the schemas differ, or a grid shares fewer than two points.
    """
    names = {str(dataset.attrs["schema"]) for dataset in datasets.values()}
    if len(names) > 1:
        raise ValueError(f"datasets of different schemas: {', '.join(sorted(names))}")
    schema = find(names.pop())
    every = list(datasets.values())
    shared = every[0]
    for other in every[1:]:
        shared = _on_shared_grids(shared, other, schema)[0]
    every = [_on_shared_grids(shared, other, schema)[1] for other in every]
    longest = {dim: max(each.sizes.get(dim, 0) for each in every) for dim in shared.dims}
    lists = {dim for dim in longest if dim in schema.lists or dim not in shared.coords}
    variables = {
        name: xr.Variable(
            (RUN, *variable.dims),
            np.stack(
                [
                    fill_up(each[name].values, tuple(longest[dim] for dim in variable.dims))
                    for each in every
                ]
            ),
            variable.attrs,
        )
        for name, variable in shared.variables.items()
        if all(name in each.variables for each in every)
        and (name not in shared.dims or name in lists & set(schema.variables))
    }
    grids = {dim: shared[dim].variable for dim in shared.dims if dim not in lists}
    attrs = {key: shared.attrs[key] for key in ("Conventions", "title", "schema")}
    return xr.Dataset(variables, {**grids, **_runs(datasets)}, attrs)


def _on_shared_grids(
    a: xr.Dataset, b: xr.Dataset, schema: DatasetSchema
) -> tuple[xr.Dataset, xr.Dataset]:
    for dim in map(str, a.dims):
        if dim not in schema.lists and dim in a.coords and dim in b.coords:
            a, b, _ = on_shared_points(a, b, dim)
    return a, b


def _runs(datasets: Mapping[str, xr.Dataset]) -> dict[str, Any]:
    """Coordinates along ``run``: names, and each configuration key that differs."""
    given = [configuration(dataset) for dataset in datasets.values()]
    changed = {
        key: [each.get(key) for each in given]
        for key in sorted(set().union(*given))
        if any(each.get(key) != given[0].get(key) for each in given)
    }
    coords: dict[str, Any] = {RUN: list(datasets)}
    for key, values in changed.items():
        numbers = all(isinstance(value, int | float) for value in values)
        coords[key.removeprefix("parameters.")] = (
            RUN,
            values if numbers else list(map(str, values)),
        )
    return coords
