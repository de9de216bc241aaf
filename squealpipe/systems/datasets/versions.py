"""Versions of the package and of the libraries that decide results."""

import functools
import importlib.metadata
import json
from collections.abc import Mapping

LIBRARIES = ("numpy", "scipy", "xarray", "netCDF4", "numba")


@functools.cache
def versions() -> Mapping[str, str]:
    """Attributes with the version of this package and of the libraries that decide results."""
    installed = {name: importlib.metadata.version(name) for name in LIBRARIES}
    libraries = json.dumps(installed, sort_keys=True, separators=(",", ":"))
    return {
        "package_version": importlib.metadata.version("squealpipe"),
        "libraries": libraries,
    }
