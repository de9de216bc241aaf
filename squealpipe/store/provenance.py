"""Where a dataset comes from: configuration slice, code, libraries, inputs, and its own id."""

from __future__ import annotations

import datetime
import importlib.metadata
import os
import platform
import subprocess
import time
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import xarray as xr

from squealpipe.store.identity import canonical, digest
from squealpipe.store.netcdf import load, save

LIBRARIES = ("numpy", "scipy", "xarray", "netCDF4", "heyoka", "numba")
VOLATILE_ATTRIBUTES = frozenset(
    {"history", "wall_time_s", "platform", "libraries", "package_version", "commit", "inputs"}
)
"""Global attributes that tell of the run, not of the result."""


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
    return dataset.assign_attrs(
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
