"""The store: atomic validated NetCDF, provenance, archives and their comparison.

Its names are loaded on first use: the workflow asks for keys of files and needs no Xarray for that.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from squealpipe.store.netcdf import load, save
    from squealpipe.store.provenance import produce
    from squealpipe.store.whole_files import StoreError

INPUT_FILES = ("netcdf.py", "provenance.py", "whole_files.py")
"""What is imported by name: a result depends on them all the same."""

__all__ = ["StoreError", "load", "produce", "save"]

_MODULES = {
    "StoreError": "whole_files",
    "load": "netcdf",
    "produce": "provenance",
    "save": "netcdf",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"squealpipe.store has no {name!r}")
    module = importlib.import_module(f"squealpipe.store.{_MODULES[name]}")
    return getattr(module, name)
