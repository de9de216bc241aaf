"""Piecewise-smooth systems: each is one file of a field, switches and a start."""

import sys
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any


class _FormerPlace(MetaPathFinder, Loader):
    """Finds the systems of ``shipped`` where 1.0.0 had them too: in this package itself."""

    def find_spec(self, fullname: str, *_rest: Any) -> ModuleSpec | None:
        """Of a module of this package that is not here but in ``shipped``."""
        package, _, name = fullname.rpartition(".")
        if package != __name__ or find_spec(f"{__name__}.shipped.{name}") is None:
            return None
        return ModuleSpec(fullname, self)

    def exec_module(self, module: ModuleType) -> None:
        """Give it what the module in ``shipped`` holds."""
        name = module.__name__.rpartition(".")[2]
        held = vars(import_module(f"{__name__}.shipped.{name}"))
        vars(module).update({k: v for k, v in held.items() if not k.startswith("__")})


sys.meta_path.append(_FormerPlace())
