"""Reproducible computation on friction-induced vibration with contact loss.

Everything public is loaded on first use, so importing one part never costs, nor makes a
workflow depend on, the others. ``__init__.pyi`` says where each name stands.
"""

import importlib
from typing import Any

import lazy_loader

_attribute, _names, __all__ = lazy_loader.attach_stub(__name__, __file__)

MODULES = ("benchmark", "functions", "structures")
"""Public modules that are found without an import of their own."""


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("squealpipe")
    if name in MODULES:
        return importlib.import_module(f"squealpipe.{name}")
    if name not in __all__:
        raise AttributeError(
            f"squealpipe has no {name!r}; it offers {', '.join(sorted(__all__))}"
        )
    return _attribute(name)


def __dir__() -> list[str]:
    return sorted([*_names(), *MODULES, "__version__"])
