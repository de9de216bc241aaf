"""NetCDF files that are either whole and valid or absent."""

from __future__ import annotations  # help shows Angle, not its checks

import datetime
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import SchemaError, schema_of, validate
from squealpipe.store.checkout import commit
from squealpipe.store.identity import dataset_id, without_foreign_key
from squealpipe.store.sealed import SEAL_MARK, verified
from squealpipe.store.whole_files import (
    StoreError,
    checksum,
    not_written,
    refuse_place,
    whole_file,
)
from squealpipe.validation import AnyPath, checked

ERRORS_OF_DAMAGED_FILES = (
    OSError,
    RuntimeError,
    ValueError,
    LookupError,
    AttributeError,
    TypeError,
    MemoryError,
)
"""Errors of netCDF-4 and Xarray on files with damaged bytes."""


@checked
def save(dataset: xr.Dataset, path: AnyPath) -> Path:
    """Write a dataset atomically, with its id: temporary name, validation, fsync, rename.

    Commit and date are added where the dataset does not state them yet. A dataset that was edited
    since a rule of the study made it loses the key of that rule, with a warning. The last line of
    the file, behind its NetCDF content, is the SHA-256 of all before it.

    Raises:
        SchemaError: the dataset does not fit its schema; nothing is written.
        StoreError: an attribute is neither text nor numbers, the folder cannot be written, or the
            path is a device or part of an archive; an earlier file of that name is untouched.
    """
    target: Path = path
    validate(dataset, schema_of(dataset))
    refuse_place(target)
    refuse_odd_attributes(dataset)
    dataset = without_foreign_key(dataset, made_now())
    made = {"commit": commit(), "history": made_now(), **dataset.attrs}
    dataset = dataset.assign_attrs({**made, "dataset_id": dataset_id(dataset)})
    encoding: dict[str, dict[str, Any]] = {
        name: {} for name in map(str, dataset.variables)
    }
    for name, how in encoding.items():
        kind = dataset[name].dtype.kind
        if kind in "fiu":
            # Xarray would declare NaN a fill value, though ours are data with a reason beside them.
            how["_FillValue"] = None
        if kind in "fiub" and dataset[name].ndim:
            how |= {"zlib": True, "complevel": 4, "shuffle": True}
    try:
        with whole_file(target) as temporary:
            dataset.to_netcdf(
                temporary, engine="netcdf4", format="NETCDF4", encoding=encoding
            )
            with temporary.open("ab") as file:
                file.write(SEAL_MARK + checksum(temporary).encode() + b"\n")
    except RuntimeError as error:  # as which netCDF-4 reports a full disk, too
        raise not_written(target, error) from error
    return target


@checked
def load(path: AnyPath, *, schema: str | None = None) -> xr.Dataset:
    """Read a dataset into memory and validate it.

    Args:
        path: a file written by :func:`save`.
        schema: the schema that the caller needs; any known one by default.

    Raises:
        FileNotFoundError: no such file.
        StoreError: the file is not whole, was changed, or is not a dataset of this package.
        SchemaError: it does not fit its schema, or not the one asked for.
    """
    source = Path(path)
    dataset = read(source)
    schema_name = str(dataset.attrs.get("schema"))
    if schema is not None and schema_name != schema:
        raise SchemaError(
            f"{source} holds {schema_name!r}, {schema!r} was expected; pass the right file"
        )
    validate(dataset, schema_of(dataset))
    return dataset


def refuse_odd_attributes(dataset: xr.Dataset) -> None:
    """Raise if an attribute is nothing that NetCDF holds, with text that can stand for it."""
    places = {"dataset": dataset.attrs} | {
        f"dataset[{str(name)!r}]": variable.attrs
        for name, variable in dataset.variables.items()
    }
    for place, attrs in places.items():
        for key, value in attrs.items():
            if isinstance(key, str) and re.fullmatch(
                r"(?!_NC)[^\W\d][\w .@+-]{0,99}", key
            ):
                if _is_text_or_numbers(value):
                    continue
                remedy = f"write {place}.attrs[{key!r}] = {str(value)!r}"
            else:
                remedy = "give it a name of letters, digits and _"
            raise StoreError(
                f"{place}.attrs[{key!r}] = {value!r} cannot be written: an attribute is a text, a "
                f"number or a list of these; {remedy}, or delete it"
            )


def _is_text_or_numbers(value: Any) -> bool:
    try:
        values = np.asarray(value)
    except ValueError:  # lists of different lengths
        return False
    stored = values.dtype.kind == "U" or values.dtype.str[1:] in (
        "i1",
        "i2",
        "i4",
        "i8",
        "u1",
        "u2",
        "u4",
        "u8",
        "f4",
        "f8",
    )
    return stored and values.ndim < 2


def made_now() -> str:
    """The line of CF's ``history`` for a dataset that is made now."""
    return f"{datetime.datetime.now(datetime.UTC):%Y-%m-%dT%H:%M:%SZ} squealpipe"


def read(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a dataset like :func:`load`, without its schema, which may have changed since."""
    source = verified(path)
    try:
        with xr.open_dataset(source, engine="netcdf4", decode_times=False) as opened:
            memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
            if opened.nbytes > memory:
                raise ValueError(
                    f"it claims {opened.nbytes} bytes, more than this machine has"
                )
            dataset = opened.load()
    except ERRORS_OF_DAMAGED_FILES as error:
        raise StoreError(
            f"{source} is truncated or not NetCDF-4 ({error}); delete it and run snakemake again"
        ) from error
    return with_plain_texts(dataset)


def with_plain_texts(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset, whose texts are NumPy's instead of objects."""
    for variable in dataset.variables.values():
        if variable.dtype == object:
            variable.values = variable.values.astype(str)
    return dataset
