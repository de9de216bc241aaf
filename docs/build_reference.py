"""Write the API reference; warnings are errors.

Usage: python docs/build_reference.py [FOLDER]   (build/reference by default)
"""

import importlib
import pkgutil
import sys
import typing
import warnings
from collections.abc import Iterator
from pathlib import Path

import pdoc

import squealpipe


def build(folder: Path) -> None:
    """Write HTML pages of every module."""
    for name in squealpipe.__all__:  # pdoc does not see what is loaded on first use
        setattr(squealpipe, name, getattr(squealpipe, name))
    pdoc.render.configure(docformat="google", math=False, search=True)
    modules = list(_specifications("squealpipe"))
    _resolve_named_tuples()
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        pdoc.pdoc(*modules, output_directory=folder)


def _resolve_named_tuples() -> None:
    """Replace annotations kept as text, which pdoc looks up in the module of NamedTuple itself."""
    for item in pkgutil.walk_packages(squealpipe.__path__, "squealpipe."):
        for value in list(vars(importlib.import_module(item.name)).values()):
            if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
                value.__new__.__annotations__ = typing.get_type_hints(value)


def _specifications(name: str) -> Iterator[str]:
    """The package, and what is inside where pdoc would not look: below a package with __all__."""
    yield name
    package = importlib.import_module(name)
    if hasattr(package, "__path__") and hasattr(package, "__all__"):
        for item in pkgutil.iter_modules(package.__path__, f"{name}."):
            if item.name.rpartition(".")[2] not in package.__all__:
                yield from _specifications(item.name)


if __name__ == "__main__":
    build(Path(sys.argv[1] if len(sys.argv) > 1 else "build/reference"))
