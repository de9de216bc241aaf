"""Batches of event-driven integrations whose lanes are refilled as soon as one finishes.

A :class:`squealpipe.systems.taylor.series.HybridSystem` is a symbolic vector field whose regime
sits in parameters, with the functions whose roots end a regime. Its Taylor series are compiled
once; a compiled loop alternates them with what happens after each step: events, observations,
refilling.

Lanes share nothing and each carries its own time, so a result does not depend on the lane, its
neighbours, the order of the jobs or the number of processes.
"""

import ctypes
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from squealpipe.systems import compiled
from squealpipe.systems.progress import report
from squealpipe.systems.taylor import simd
from squealpipe.systems.taylor.machine import address_of_entry
from squealpipe.systems.taylor.memory import contiguous
from squealpipe.systems.taylor.series import (
    HybridSystem,
    longest_source,
    perturbation_source,
    series_source,
    shorten_source,
    verify_source,
)
from squealpipe.systems.taylor.writing import compile_source

_numba: Any = numba
_cgutils: Any = cgutils
ROUNDS = 4096
"""Steps of all lanes between two returns from compiled code: some ten milliseconds."""
MOST_TERMS = 64
INVERSES = 1.0 / np.maximum(1.0, np.arange(MOST_TERMS))


@dataclass(frozen=True, eq=False)
class CompiledSystem:
    """Addresses of a system's functions by name, and the number of series that it keeps."""

    code: dict[str, int]
    n_series: int

    def address(self, name: str) -> int:
        """Return the address of a function; 0 of one that is left out."""
        return self.code.get(name, 0)


def compile_system(
    system: HybridSystem,
    further: Mapping[str, str] = MappingProxyType({}),
    *,
    tangent: bool,
    few: bool = False,
) -> CompiledSystem:
    """Write and compile the functions of a system, or take them from the store.

    Args:
        further: sources of its functions of one state.
        few: compute the first ``simd.FEW`` lanes only.
    """
    series, n_series = series_source(system)
    sources = {"series": series}
    if system.checked():
        sources["verify"] = verify_source(system)
    if shorten := shorten_source(system):
        sources["shorten"] = shorten
    if tangent:
        sources |= {
            "perturb": perturbation_source(system),
            "longest": longest_source(system),
        }
    width = simd.FEW if few else simd.LANES
    code = {name: compile_source(text, width) for name, text in sources.items()}
    code |= {name: compile_source(text) for name, text in further.items()}
    return CompiledSystem(code, n_series)


def _to_number(typing_context: Any, value: Any) -> Any:
    """Turn a pointer into an integer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = context.get_value_type(types.intp)
        return builder.ptrtoint(arguments[0], word)

    return types.intp(types.voidptr), generate


address_of: Any = intrinsic(_to_number)


def _call(typing_context: Any, function: Any, arguments: Any) -> Any:
    """Call the C function at an address with addresses and sizes."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        word = context.get_value_type(types.intp)
        given = _cgutils.unpack_tuple(builder, values[1], len(signature.args[1]))
        kind = ir.FunctionType(ir.VoidType(), [word] * len(given))
        builder.call(builder.inttoptr(values[0], kind.as_pointer()), given)
        return context.get_dummy_value()

    return types.void(types.intp, arguments), generate


call: Any = intrinsic(_call)


def _view(typing_context: Any, address: Any, shape: Any, element: Any) -> Any:
    """Make the array at an address."""
    kind = types.Array(element.dtype, len(shape), "C")

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kinds = signature.args[1]
        given = _cgutils.unpack_tuple(builder, values[1], len(kinds))
        sizes = [
            context.cast(builder, size, of, types.intp)
            for size, of in zip(given, kinds, strict=True)
        ]
        return contiguous(context, builder, kind, values[0], sizes)

    return kind(types.intp, shape, element), generate


view: Any = intrinsic(_view)


def record_viewer(record: np.dtype) -> Any:
    """Return a compiled function that gives the record of a type at an address."""
    kind = _numba.from_dtype(record)

    def at(typing_context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return builder.inttoptr(values[0], context.get_value_type(kind))

        return kind(types.intp), generate

    return intrinsic(at)


class Workspace:
    """Addresses of arrays and sizes for a compiled function, as one record; keeps the arrays."""

    def __init__(
        self, record: np.dtype, arrays: Mapping[str, np.ndarray], sizes: dict[str, int]
    ) -> None:
        for name, array in arrays.items():
            if not array.flags.c_contiguous or array.dtype.itemsize % 8:
                raise ValueError(
                    f"{name}: the workspace holds contiguous 8-byte fields only"
                )
        self.arrays = dict(arrays)
        at = {name: _address_of(array) for name, array in arrays.items()} | sizes
        self.table = np.array([tuple(at[name] for name in record.names or ())], record)

    @property
    def pointer(self) -> ctypes.c_void_p:
        """Return the address of the table."""
        return ctypes.c_void_p(self.table.ctypes.data)


def _address_of(array: np.ndarray) -> int:
    """Return ``array.ctypes.data``, which itself takes a single run twice as long."""
    if array.dtype.names:
        return array.ctypes.data
    buffer: Any = array
    start = ctypes.c_char * 0
    return ctypes.addressof(start.from_buffer(buffer))


def compile_advance(
    advance: Callable[..., Any], folder: Path | None = None, *, vectorize: bool = True
) -> Any:
    """Return a C function of ``advance(table) -> busy lanes``, stored by a digest of this folder.

    Args:
        folder: another one whose sources count.
        vectorize: let LLVM look for loops over numbers side by side.
    """
    signature = types.intp(types.voidptr)
    address = address_of_entry(
        advance, signature, sources_of(folder), vectorize=vectorize
    )
    return ctypes.CFUNCTYPE(ctypes.c_ssize_t, ctypes.c_void_p)(address)


def compile_called(function: Callable[..., Any], words: int, folder: Path) -> int:
    """Return the address of a C function of addresses and numbers, which compiled code calls.

    Args:
        words: number of its arguments.
        folder: one whose sources count beside this one's.
    """
    signature = types.void(*[types.intp] * words)
    return address_of_entry(function, signature, sources_of(folder))


def invoke(address: int, *words: int) -> None:
    """Call a C function of addresses and numbers by its address."""
    kind = ctypes.CFUNCTYPE(None, *[ctypes.c_ssize_t] * len(words))
    kind(address)(*words)


@cache
def sources_of(folder: Path | None) -> bytes:
    """Return the sources of this folder and of another one, and of how parts are compiled."""
    folders = [Path(__file__).parent, *([] if folder is None else [folder])]
    paths = [path for each in folders for path in sorted(each.glob("*.py"))]
    return b"".join(path.read_bytes() for path in (Path(compiled.__file__), *paths))


def drive(
    advance: Any, workspace: Workspace, share: Callable[[], float] = lambda: 0.0
) -> None:
    """Call ``advance``, which returns every ``ROUNDS`` steps, until it reports no lane busy.

    Between two calls an interrupt is heard, and ``share`` says how much of the work is done.
    """
    while advance(workspace.pointer):
        report(share)


def share_of(
    job: np.ndarray, clock: np.ndarray, t_end: np.ndarray, left: np.ndarray
) -> float:
    """Return the share of their jobs that the lanes of a process have done.

    Args:
        job, clock, t_end: of each lane; the job is negative in an idle one.
        left: next job of this process, number of all jobs, number of processes.
    """
    following, count, stride = left.tolist()
    runs = job >= 0
    busy = float((1.0 - clock[runs] / t_end[runs]).sum())
    return float(
        1.0 - (max(count - following, 0) / stride + busy) / max(count / stride, 1.0)
    )


def taylor_terms(tol: float) -> int:
    """Return the number of Taylor coefficients for a tolerance.

    Two orders more than a step's own error asks for (Jorba and Zou 2005), since errors of a
    hundred steps add up and grow.
    """
    return max(2, math.ceil(1.0 - 0.5 * math.log(tol))) + 3


def aligned(*shape: int) -> np.ndarray:
    """Return zeros whose rows of ``LANES`` start where ``simd`` wants them."""
    size = math.prod(shape)
    store = np.zeros(size + simd.ALIGNMENT // 8)
    first = -store.ctypes.data // 8 % (simd.ALIGNMENT // 8)
    return store[first : first + size].reshape(shape)
