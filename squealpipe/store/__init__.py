"""The store: atomic validated NetCDF, provenance, archives and their comparison."""

from squealpipe.store.netcdf import StoreError, load, save
from squealpipe.store.provenance import produce

__all__ = ["StoreError", "load", "produce", "save"]
