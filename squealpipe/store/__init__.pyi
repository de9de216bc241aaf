from .netcdf import load, save
from .provenance import produce
from .whole_files import StoreError

__all__ = ["StoreError", "load", "produce", "save"]
