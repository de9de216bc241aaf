"""A whole run as one tree of datasets."""

from __future__ import annotations  # help shows Angle, not its checks

import os

import xarray as xr

from squealpipe.store.netcdf import read
from squealpipe.store.runs import dataset_files, locate, refuse_copy
from squealpipe.validation import AnyPath, checked


@checked
def open_results(
    name_or_path: AnyPath, *, root: str | os.PathLike[str] = "."
) -> xr.DataTree:
    """The datasets of a run as a tree: one node each, by their names below ``data/``.

    Every file is checked against its checksum.

    Args:
        name_or_path: an archive by its name, or a folder of results.
        root: the checkout, where archives are looked up by name.

    Returns:
        The tree; ``tree["stability_map"]`` and ``tree["backbone/F10_mode1"]`` are its nodes.

    Raises:
        FileNotFoundError: no such archive or folder.
        StoreError: a file is damaged, a copy under another name, or no dataset of this package.
    """
    place = locate(name_or_path, root)
    datasets = {}
    for name, path in dataset_files(place).items():
        datasets[name] = read(path)
        refuse_copy(name, path, datasets[name].attrs)
    return xr.DataTree.from_dict(datasets, name=place.name)
