"""A whole run as one tree of datasets."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import DatasetSchema, schema_of
from squealpipe.schema.sweep import fill_up
from squealpipe.store.comparison.compare import configuration
from squealpipe.store.comparison.matching import on_shared_points
from squealpipe.store.netcdf import StoreError, read
from squealpipe.store.runs import dataset_files, locate
from squealpipe.validation import checked

RUN = "run"

Place = str | os.PathLike[str]


@checked
def open_results(
    name_or_path: Place | Sequence[Place], *, along: str | None = None, root: Place = "."
) -> xr.DataTree:
    """The datasets of a run as a tree: one node each, by their names below ``data/``.

    Every file is held against its checksum.

    Args:
        name_or_path: an archive by its name, or a folder of results; with ``along`` a list.
        along: "run" stacks each dataset that all runs have along a new dimension ``run``, whose
            coordinates are the runs' names and every parameter that differs. Grids are cut to the
            points that all share; shorter lists are filled up as in a sweep.
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
            {name: _load(name, path) for name, path in files.items()}, name=place.name
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
        {
            name: stacked({run: _load(name, files[name]) for run, files in runs.items()})
            for name in shared
        }
    )


def _load(name: str, path: Path) -> xr.Dataset:
    """A dataset of a run; a copy under another name is refused."""
    dataset = read(path)
    stated = str(dataset.attrs.get("key", "")).partition(" ")[2]
    if stated not in {"", f"data/{name}.nc"}:
        raise StoreError(f"{path} is a copy of {stated}; delete it and run snakemake again")
    return dataset


def stacked(datasets: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Datasets of one schema along ``run``; changed parameters become coordinates of it.

    Raises:
        ValueError: the schemas differ, or a grid shares fewer than two points.
    """
    names = {str(dataset.attrs["schema"]) for dataset in datasets.values()}
    if len(names) > 1:
        raise ValueError(f"datasets of different schemas: {', '.join(sorted(names))}")
    every = list(datasets.values())
    schema = schema_of(every[0])
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
