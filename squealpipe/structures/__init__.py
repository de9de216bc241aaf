"""Structures: matrices of finite elements with contacts on a belt, and their complex modes.

Its names are loaded on first use: readers of files ask for the schemas alone.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from squealpipe.structures.contact import Contact
    from squealpipe.structures.meshes.faces import Face, Rotation
    from squealpipe.structures.shipped_pad import elastic_pad
    from squealpipe.structures.structure import Structure

INPUT_FILES = ("contact.py", "meshes/faces.py", "shipped_pad.py", "structure.py")
"""What is imported by name: a result depends on them all the same."""

__all__ = ["Contact", "Face", "Rotation", "Structure", "elastic_pad"]

_MODULES = {
    "Contact": "contact",
    "Face": "meshes.faces",
    "Rotation": "meshes.faces",
    "Structure": "structure",
    "elastic_pad": "shipped_pad",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"squealpipe.structures has no {name!r}")
    module = importlib.import_module(f"squealpipe.structures.{_MODULES[name]}")
    return getattr(module, name)
