"""Linear algebra by one thread.

OpenBLAS wakes all its threads for each small matrix, and where other work keeps the cores busy they
wait for one another: the search for a cycle of Chua's circuit took 81 s on two busy cores instead
of 0.7, and complex factors by SuperLU, which hands over panels of few columns, 30 times as long.
"""

import ctypes
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache

Control = tuple[Callable[[], int], Callable[[int], None]]
"""Functions that return and set a library's number of threads."""

_LOCK = threading.Lock()
_inside: list[tuple[Control, int]] = []
_callers = 0


@lru_cache
def _control(path: str) -> Control | None:
    """Return the control of the BLAS behind a compiled module; None of another BLAS."""
    library = ctypes.CDLL(path)
    for name in ("scipy_openblas_{}_num_threads", "openblas_{}_num_threads"):
        for get in (name.format("get"), name.format("get") + "64_"):
            if hasattr(library, get):
                return getattr(library, get), getattr(
                    library, get.replace("_get_", "_set_")
                )
    return None


def _controls() -> list[Control]:
    """Return the controls of NumPy's and SciPy's BLAS, as far as they are loaded."""
    loaded = (
        sys.modules.get(name)
        for name in ("numpy.linalg._umath_linalg", "scipy.linalg._fblas")
    )
    controls = (_control(str(module.__file__)) for module in loaded if module)
    return [control for control in controls if control]


@contextmanager
def one_thread() -> Iterator[None]:
    """Have NumPy's and SciPy's linear algebra done by one thread, where their BLAS can be told so.

    Calls may be nested, or come from several threads: the last one to end restores the number.
    """
    global _callers  # noqa: PLW0603
    with _LOCK:
        _callers += 1
        known = [control for control, _ in _inside]
        for control in _controls():
            if control not in known:
                _inside.append((control, control[0]()))
                control[1](1)
    try:
        yield
    finally:
        with _LOCK:
            _callers -= 1
            if not _callers:
                for control, before in _inside:
                    control[1](before)
                _inside.clear()
