"""What numba compiles, and where its machine code is kept between runs.

A function is compiled by who calls it:

- :func:`compiled`: Python calls it;
- :func:`compiled_entry`: its address is called: a whole loop, or source text made at run time;
- ``part``: other compiled code calls it, so there are no wrappers to compile;
- ``inline``: likewise in every step, where passing a dozen arrays costs as much as the work;
- ``polynomial``: likewise with fused multiply-add, which halves the time of a Horner chain;
- ``also_compiled``: a law or rule in plain Python, which compiled code calls as it stands.

Only the first two are stored, each with all that it calls. numba decides by a function's own file
whether its stored code is current, but that code contains what it calls from other files. Each
store is therefore keyed by a digest of every source: an edit of any of them compiles all again,
and none is ever stale. (heyoka compiles expressions of its own, in
:mod:`squealpipe.methods.taylor.taylor_compiler`, and stores nothing.)
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core import config
from numba.extending import register_jitable

_numba: Any = numba
_settings: Any = config  # numba's untyped settings, the home of CACHE_DIR
_Kernel = TypeVar("_Kernel", bound=Callable[..., Any])
_PART: dict[str, Any] = {
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
_MARK = b"from squealpipe.methods.compiled import compiled\n"

part = _numba.njit(**_PART)
inline = _numba.njit(forceinline=True, **_PART)
polynomial = _numba.njit(fastmath={"contract"}, **_PART)
also_compiled: Any = register_jitable(**_PART)


def kernel_sources() -> list[Path]:
    """This file and every module beside or below it that compiles kernels."""
    here = Path(__file__)
    users = [path for path in sorted(here.parent.rglob("*.py")) if _MARK in path.read_bytes()]
    return [here, *(path for path in users if path != here)]


@cache
def _store() -> str:
    """Directory of the kernels that Python calls, by a digest of them all."""
    return _folder("kernels", b"".join(source.read_bytes() for source in kernel_sources()))


def _folder(kind: str, content: bytes) -> str:
    """The user's numba directory or the package's own, and in it one for this content."""
    root = Path(_settings.CACHE_DIR or Path(__file__).parent / "__pycache__")
    return str(root / f"{kind}-{hashlib.sha256(content).hexdigest()[:16]}")


def _kept(make: Callable[..., Any], folders: Sequence[str]) -> Any:
    """``make(cache=True)`` with the first folder that can be written; else without a store."""
    previous = _settings.CACHE_DIR
    for folder in folders:
        _settings.CACHE_DIR = folder
        try:
            return make(cache=True)
        except (RuntimeError, OSError):
            continue
        finally:
            _settings.CACHE_DIR = previous
    return make(cache=False)


def compiled(function: _Kernel) -> _Kernel:
    """Compile on first call, without the interpreter lock; keep the result where one can write.

    Where the package's directory is read-only numba's own choice (the user's cache) is taken, and
    where nothing can be written the kernel is compiled anew in each process.
    """

    def make(*, cache: bool) -> Any:
        return numba.njit(cache=cache, nogil=True, error_model="numpy")(function)

    return cast("_Kernel", _kept(make, (_store(), _settings.CACHE_DIR)))


def compiled_entry(function: Callable[..., Any], signature: Any, content: bytes) -> Any:
    """A C function, compiled now; stored under a digest of all ``content`` that it is made of.

    Compiling takes seconds. Where nothing can be written it is done in each process.
    """

    def make(*, cache: bool) -> Any:
        return _numba.cfunc(signature, error_model="numpy", cache=cache)(function)

    return _kept(make, (_folder("lanes", content),))
