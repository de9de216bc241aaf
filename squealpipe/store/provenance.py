"""Where a dataset comes from: configuration slice, code, libraries, inputs, and its own id."""

from __future__ import annotations

import datetime
import hashlib
import importlib.metadata
import json
import os
import platform
import subprocess
import time
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import find
from squealpipe.store.netcdf import load, save

LIBRARIES = ("numpy", "scipy", "xarray", "netCDF4", "heyoka", "numba")
VOLATILE_ATTRIBUTES = frozenset(
    {"history", "wall_time_s", "platform", "libraries", "package_version", "commit", "inputs"}
)
"""Global attributes that tell of the run, not of the result."""


def canonical(config: Any) -> str:
    """One text for one meaning: sorted keys, no white space."""
    return json.dumps(config, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest(text: str | bytes) -> str:
    """Sixteen hexadecimal digits of SHA-256."""
    return hashlib.sha256(text.encode() if isinstance(text, str) else text).hexdigest()[:16]


def dataset_id(dataset: xr.Dataset) -> str:
    """Hash of what was computed: schema, configuration and all values that are not volatile."""
    schema = find(str(dataset.attrs["schema"]))
    total = hashlib.sha256()
    total.update(canonical([schema.name, schema.version, dataset.attrs.get("config", "")]).encode())
    for name in sorted(map(str, dataset.variables)):
        entry = schema.lookup(name)
        if entry is not None and entry.volatile:
            continue
        values = np.ascontiguousarray(dataset[name].values)
        total.update(f"{name}{values.shape}{values.dtype.kind}".encode())
        total.update(
            repr(values.tolist()).encode() if values.dtype.kind in "UO" else values.tobytes()
        )
    return total.hexdigest()[:16]


def produce(
    make: Callable[[], xr.Dataset],
    *,
    config: Mapping[str, Any],
    output: str | os.PathLike[str],
    inputs: Iterable[str | os.PathLike[str]] = (),
) -> Path:
    """Run a task, stamp the result with its provenance, and save it.

    Args:
        make: the task, ready to call.
        config: exactly the configuration that the task was given.
        output: where the dataset goes.
        inputs: NetCDF files that the task read.
    """
    started = time.perf_counter()
    dataset = make()
    wall_time = time.perf_counter() - started
    return save(stamp(dataset, config=config, inputs=inputs, wall_time=wall_time), output)


def stamp(
    dataset: xr.Dataset,
    *,
    config: Mapping[str, Any],
    inputs: Iterable[str | os.PathLike[str]] = (),
    wall_time: float,
) -> xr.Dataset:
    """The dataset with provenance attributes."""
    text = canonical(config)
    stamped = dataset.assign_attrs(
        config=text,
        config_hash=digest(text),
        package_version=importlib.metadata.version("squealpipe"),
        commit=commit(),
        libraries=canonical({name: importlib.metadata.version(name) for name in LIBRARIES}),
        platform=f"{platform.platform()}, Python {platform.python_version()}",
        inputs=canonical({str(path): load(path).attrs["dataset_id"] for path in inputs}),
        wall_time_s=wall_time,
        history=f"{datetime.datetime.now(datetime.UTC):%Y-%m-%dT%H:%M:%SZ} squealpipe",
    )
    return stamped.assign_attrs(dataset_id=dataset_id(stamped))


@cache
def commit() -> str:
    """Commit of the checkout that the package runs from, with a mark if it has changes."""
    root = Path(__file__).resolve().parents[2]
    try:
        described = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=12"],
            cwd=root,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return described.stdout.strip()
