"""The store: atomic validated NetCDF, provenance, archives and their comparison."""

from squealpipe.store.netcdf import load, save
from squealpipe.store.provenance import produce
from squealpipe.store.whole_files import StoreError

__all__ = ["StoreError", "load", "produce", "save"]
