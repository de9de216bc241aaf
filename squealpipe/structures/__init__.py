"""Structures: matrices of finite elements with contacts on a belt, and their complex modes.

Its names are loaded on first use: readers of files ask for the schemas alone.
"""

import lazy_loader

INPUT_FILES = (
    "contact.py",
    "meshes/faces.py",
    "shipped_disc.py",
    "shipped_pad.py",
    "structure.py",
)
"""Files that are imported by name: a result depends on them all the same."""

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
