"""The store: atomic validated NetCDF, provenance, archives and their comparison.

Its names are loaded on first use: the workflow asks for keys of files and needs no Xarray for that.
"""

import lazy_loader

INPUT_FILES = ("netcdf.py", "provenance.py", "whole_files.py")
"""Files that are imported by name: a result depends on them all the same."""

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
