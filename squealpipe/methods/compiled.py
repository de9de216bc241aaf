"""Compilation of the numeric kernels, kept on disk between runs.

numba decides by a function's own file whether its stored machine code is current, but that code
contains the kernels it calls from other files. The store is therefore keyed by a digest of every
kernel source: an edit of any of them compiles all again, and none is ever stale.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config

_settings: Any = config  # numba's untyped settings, the home of CACHE_DIR
_Kernel = TypeVar("_Kernel", bound=Callable[..., Any])
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
_MARK = b"from squealpipe.methods.compiled import compiled"


def kernel_sources() -> list[Path]:
    """This file and every module beside it that compiles kernels."""
    here = Path(__file__)
    users = [path for path in sorted(here.parent.glob("*.py")) if _MARK in path.read_bytes()]
    return [here, *(path for path in users if path != here)]


@cache
def _store() -> str:
    """Directory of the compiled code: the user's numba directory or the package's, by digest."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for source in kernel_sources():
        digest.update(source.read_bytes())
    root = Path(_settings.CACHE_DIR) if _settings.CACHE_DIR else here / "__pycache__"
    return str(root / f"kernels-{digest.hexdigest()[:16]}")


def compiled(function: _Kernel) -> _Kernel:
    """Compile on first call, without the interpreter lock; keep the result where one can write.

    Where the package's directory is read-only numba's own choice (the user's cache) is taken, and
    where nothing can be written the kernel is compiled anew in each process.
    """
    previous = _settings.CACHE_DIR
    for directory in (_store(), previous):
        _settings.CACHE_DIR = directory
        try:
            return cast("_Kernel", numba.njit(cache=True, **_OPTIONS)(function))
        except (RuntimeError, OSError):
            continue
        finally:
            _settings.CACHE_DIR = previous
    return cast("_Kernel", numba.njit(**_OPTIONS)(function))
