"""SIMD batches of event-driven integrations whose lanes are refilled as soon as one finishes.

A :class:`HybridSystem` is a symbolic vector field whose regime sits in parameters, with the
functions whose roots end a regime. heyoka compiles it once a process for a batch of lanes. The
driver alternates one Taylor step of all lanes with one call of a compiled function, which handles
the events, observes the step through its Taylor coefficients and refills finished lanes.

Lanes share nothing and each carries its own time, so a result does not depend on the lane, its
neighbours, the order of the jobs or the number of processes.
"""

from __future__ import annotations

import ctypes
import gc
import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import heyoka
import numba
import numpy as np
from numba import types
from numba.core import cgutils, config
from numba.extending import intrinsic

from squealpipe.methods import taylor_compiler

_numba: Any = numba
PART_OPTIONS: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of functions that compiled code alone calls: no wrappers to compile."""
part = _numba.njit(error_model="numpy", **PART_OPTIONS)
"""Compiles a function that compiled code calls."""
inline = _numba.njit(error_model="numpy", forceinline=True, **PART_OPTIONS)
"""The same for the path of every step, where passing a dozen arrays costs as much as the work."""

LANES = 16
"""Lanes of a batch: the width of AVX-512; other numbers are no faster and change last digits."""


@dataclass(frozen=True, eq=False)
class HybridSystem:
    """A vector field with switched parameters and the functions whose roots switch them.

    Attributes:
        equations: (variable, right-hand side) pairs of heyoka expressions.
        events: expressions; each root ends the step there.
    """

    equations: tuple[tuple[Any, Any], ...]
    events: tuple[Any, ...]


def batch_integrator(system: HybridSystem, tol: float) -> Any:
    """heyoka's adaptive Taylor integrator for one batch, stopping each lane at its events.

    Cooldowns are zero: after an event the state is moved off the event's surface instead, which
    also finds the second root of a grazing pair.
    """
    taylor_compiler.set_up()
    return heyoka.taylor_adaptive_batch(
        list(system.equations),
        np.zeros((len(system.equations), LANES)),
        tol=tol,
        t_events=[heyoka.t_event_batch(event, cooldown=0.0) for event in system.events],
    )


def _to_pointer(typing_context: Any, value: Any) -> Any:  # noqa: ARG001
    """An integer as a pointer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.intp), generate


_address: Any = intrinsic(_to_pointer)


@part
def float_view(address: int, shape: Any) -> Any:
    """The float64 array at an address."""
    return _numba.carray(_address(address), shape, np.float64)


@part
def integer_view(address: int, shape: Any) -> Any:
    """The int64 array at an address."""
    return _numba.carray(_address(address), shape, np.int64)


class Workspace:
    """Addresses of arrays for a compiled function, and the arrays themselves, kept alive."""

    def __init__(self, arrays: Sequence[np.ndarray], sizes: Sequence[int]) -> None:
        for array in arrays:
            if not array.flags.c_contiguous or array.dtype.itemsize != 8:
                raise ValueError("the workspace holds contiguous 8-byte arrays only")
        self.arrays = tuple(arrays)
        self.table = np.array([array.ctypes.data for array in arrays] + list(sizes), np.int64)

    @property
    def pointer(self) -> ctypes.c_void_p:
        """Address of the table."""
        return ctypes.c_void_p(self.table.ctypes.data)


def compile_advance(advance: Callable[..., Any], sources: Iterable[Path]) -> Any:
    """A C function from ``advance(table) -> busy lanes``; Python calls it in 0.2 µs.

    Compiling takes seconds, so the machine code is kept beside the package's byte code, under a
    digest of all ``sources`` that it is made from: an edit of any of them compiles anew.
    """
    digest = hashlib.sha256()
    for source in sorted(sources):
        digest.update(source.read_bytes())
    signature = types.intp(_numba.types.CPointer(types.intp))
    numba_config: Any = config
    previous = numba_config.CACHE_DIR
    root = Path(previous) if previous else Path(__file__).parent / "__pycache__"
    numba_config.CACHE_DIR = str(root / f"lanes-{digest.hexdigest()[:16]}")
    try:
        compiled = _numba.cfunc(signature, error_model="numpy", cache=True)(advance)
    except (RuntimeError, OSError):
        # Nothing can be written there: compile in each process.
        compiled = _numba.cfunc(signature, error_model="numpy")(advance)
    finally:
        numba_config.CACHE_DIR = previous
    function: Any = ctypes.CFUNCTYPE(ctypes.c_ssize_t, ctypes.c_void_p)(compiled.address)
    # The wrapper does not own the machine code.
    function.code = compiled
    return function


def drive(integrator: Any, advance: Any, workspace: Workspace) -> None:
    """Step all lanes until ``advance`` reports none busy; its first call fills them."""
    step, pointer = integrator.step, workspace.pointer
    with _no_garbage_collection():
        while advance(pointer):
            step()


@contextmanager
def _no_garbage_collection() -> Iterator[None]:
    """Spare a loop that makes no cycles the collector, which costs it 7 % of its time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()
