"""Functions of arrays and numbers that Python calls, compiled together as one module.

Idea: what several of them call is optimized once, and LLVM alone loads them. numba would compile
each anew with all that it calls, and import what it infers types by to load them.
Invariant: arrays are contiguous, with elements and dimensions as the annotations say.
"""

import ctypes
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TypeVar, cast

import numpy as np
from numba import types

from squealpipe.systems.compiled import Inner, part
from squealpipe.systems.taylor.lanes import sources_of, view
from squealpipe.systems.taylor.machine import addresses_of_entries
from squealpipe.systems.taylor.simd import number, word

Vector = Annotated[Any, np.dtype(float), 1]
Matrix = Annotated[Any, np.dtype(float), 2]
# places of pointers in numpy's objects: to the numbers of an array, its sizes, and a record
_DATA = object.__basicsize__
_DIMENSIONS, _RECORD = _DATA + 16, tuple.__basicsize__
_Function = TypeVar("_Function", bound=Callable[..., Any])
_Inner: Any = Inner
# by annotation: types for numba and for ctypes, and form of a packed word
_numbers: dict[Any, tuple[Any, Any, str]] = {
    int: (types.intp, ctypes.c_ssize_t, "q"),
    float: (types.float64, ctypes.c_double, "d"),
    None: (types.void, None, ""),
}


class _Kernel(_Inner):  # type: ignore[misc]
    """A function that compiled code calls as a part of it, and Python by its address."""

    def __call__(self, *given: Any) -> Any:
        """Call the C function."""
        if self.entry is None:
            self.kernels.compile()
        return self.entry(*given)


def _checked(array: Any, kind: Any, name: str) -> int:
    """Return the address of an array's object, whose numbers compiled code takes as they are."""
    if array.dtype != kind or not array.flags.c_contiguous:
        raise TypeError(f"{name}: a contiguous array of {kind} is needed")
    return id(array)


class Kernels:
    """Decorator of functions that are compiled together, when the first of them is called.

    Args:
        folder: their sources, of which those that are imported by then are compiled.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._kernels: list[Any] = []

    def __call__(self, function: _Function) -> _Function:
        """Let compiled code and Python call a function, whose annotations say of what it is."""
        kernel: Any = part(function)
        kernel.__class__, kernel.kernels, kernel.entry = _Kernel, self, None
        self._kernels.append(kernel)
        return cast("_Function", kernel)

    def compile(self) -> None:
        """Compile the functions, or take them from the store."""
        entries = list(map(_entry, self._kernels))
        addresses = addresses_of_entries(
            [each[:2] for each in entries], sources_of(self._folder)
        )
        for kernel, (_, _, caller), address in zip(
            self._kernels, entries, addresses, strict=True
        ):
            kernel.entry = caller(address)


def _entry(kernel: Any) -> tuple[Any, Any, Callable[[int], Any]]:
    """Return a kernel as a function of packed words, its signature, and what calls it."""
    function = kernel.py_func
    annotations = dict(function.__annotations__)
    result, result_of_c, _ = _numbers[annotations.pop("return")]
    form, given, passed = "", [], []
    scope = {"__name__": function.__module__, "kernel": kernel, "checked": _checked}
    scope |= {"view": view, "word": word, "number": number}
    for place, (name, kind) in enumerate(annotations.items()):
        if kind in _numbers:
            form += _numbers[kind][2]
            read = "number" if kind is float else "word"
            given.append(f"{read}(words + {8 * place})")
            passed.append(name)
            continue
        form += "q"
        scope[f"{name}_kind"], n_dimensions = kind.__metadata__
        at = f"word(words + {8 * place})"
        sizes = [
            f"word(word({at} + {_DIMENSIONS}) + {8 * axis})"
            for axis in range(n_dimensions)
        ]
        data = f"word({at} + {_DATA if sizes else _RECORD})"
        array = f"view({data}, ({', '.join(sizes) or 1},), {name}_kind)"
        given.append(array if sizes else f"{array}[0]")
        # what is usual is looked at here: a call would take as long
        passed.append(
            f"id({name}) if {name}.dtype is {name}_kind and {name}.flags.c_contiguous "
            f"else checked({name}, {name}_kind, {name!r})"
        )
    scope["pack"] = struct.Struct(form).pack
    exec(  # noqa: S102
        f"def {function.__name__}(words): return kernel({', '.join(given)})\n"
        f"def caller(entry): return lambda {', '.join(annotations)}: "
        f"entry(pack({', '.join(passed)}))",
        scope,
    )
    caller: Any = scope["caller"]
    of_c = ctypes.CFUNCTYPE(result_of_c, ctypes.c_char_p)
    return (
        scope[function.__name__],
        result(types.intp),
        lambda address: caller(of_c(address)),
    )
