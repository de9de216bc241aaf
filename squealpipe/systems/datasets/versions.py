"""Versions of the package and of the libraries that decide results."""

import functools
import importlib.metadata
import json
from collections.abc import Mapping


@functools.cache
def versions() -> Mapping[str, str]:
    """Attributes with the version of this package and of the libraries that decide results."""
    computing_libraries = ("numpy", "scipy", "xarray", "netCDF4", "numba")
    installed = {name: importlib.metadata.version(name) for name in computing_libraries}
    libraries = json.dumps(installed, sort_keys=True, separators=(",", ":"))
    return {
        "package_version": importlib.metadata.version("squealpipe"),
        "libraries": libraries,
    }
