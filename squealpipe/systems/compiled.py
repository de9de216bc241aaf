"""Compile parts of kernels by numba, and say where machine code is kept between runs.

A function is compiled by who calls it:

- ``part``: other compiled code calls it, so there are no wrappers to compile, and no counts of
  references to arrays (an eighth of the time), so it makes none and returns none;
- ``views``: likewise where it makes views of memory that others keep, and returns them;
- ``inline``: likewise in every step, where passing a dozen arrays costs as much as the work, and
  ``inline_views`` where it returns views of which few are used;
- ``polynomial``: likewise with fused multiply-add, which halves the time of a Horner chain.

Whole loops that are called by their addresses, and source text made at run time, are compiled and
kept in :mod:`squealpipe.systems.taylor.machine`; functions that Python calls with arrays, in
:mod:`squealpipe.systems.taylor.kernels`. (heyoka compiles expressions of its own, in
:mod:`tests.oracles.a1_long_double`, and stores nothing.)
"""

import gc
import hashlib
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba import types
from numba.core import event, ir, ir_utils, typed_passes, untyped_passes
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass
from numba.core.registry import CPUDispatcher

from squealpipe.systems.progress import stage

_numba: Any = numba
_settings: Any = numba.config  # untyped, the home of CACHE_DIR
_Dispatcher: Any = CPUDispatcher
_Compiler: Any = CompilerBase
_Pass: Any = FunctionPass
_register_pass: Any = register_pass
_ir: Any = ir
_ir_utils: Any = ir_utils
_Passes: Any = PassManager
_Function: Any = types.Function
_widened: Any = types.unliteral


@_register_pass(mutates_CFG=False, analysis_only=False)
class _PlacesOfTuples(_Pass):  # type: ignore[misc]
    """Write constant places as such: of a tuple they decide about the type.

    numba looks for constants in every index, by an error for each that is none.
    """

    _name = "places_of_tuples"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Rewrite the code of a function before its types are inferred."""
        code = state.func_ir
        for block in code.blocks.values():
            for each in block.find_insts(_ir.Assign):
                value = each.value
                if getattr(value, "op", None) == "getitem":
                    place = _ir_utils.guard(_ir_utils.find_const, code, value.index)
                    if isinstance(place, int):
                        each.value = _ir.Expr.static_getitem(
                            value.value, place, value.index, value.loc
                        )
        return True


class KernelCompiler(_Compiler):  # type: ignore[misc]
    """numba's passes that loops over numbers need.

    The others look for closures, generators, expressions of whole arrays and the like in vain.
    """

    def define_pipelines(self) -> list[Any]:
        """Return the passes."""
        passes = _Passes("kernel")
        for each in (
            untyped_passes.TranslateByteCode,
            untyped_passes.FixupArgs,
            untyped_passes.IRProcessing,
            untyped_passes.RewriteSemanticConstants,
            untyped_passes.DeadBranchPrune,
            _PlacesOfTuples,
            untyped_passes.ReconstructSSA,
            typed_passes.NopythonTypeInference,
            typed_passes.PreLowerStripPhis,
            # notes where each variable ends, which counts of references alone need
            *([typed_passes.IRLegalization] if self.state.flags.nrt else []),
            typed_passes.NativeLowering,
            typed_passes.NoPythonBackend,
        ):
            passes.add_pass(each, each.__name__)
        passes.finalize()
        return [passes]


class Inner(_Dispatcher):  # type: ignore[misc]
    """A function that only compiled code calls; once for a number that is known and for others."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return how it is called, as numba has it, with the types of constants widened."""
        kws = {name: _widened(kind) for name, kind in kws.items()}
        return super().get_call_template([_widened(kind) for kind in args], kws)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ARG002 (numba's signature)
        """Raise, where numba would jump to an address that there is not and end the process."""
        name = self.py_func.__qualname__
        raise TypeError(
            f"{name} has no wrapper for Python: call it from compiled code, or {name}.py_func, its "
            "Python code"
        )


def _inner(**options: Any) -> Any:
    """Return the decorator of functions that only compiled code calls."""

    def compile_(function: Callable[..., Any]) -> Any:
        kernel = _numba.njit(pipeline_class=KernelCompiler, **options)(function)
        kernel.__class__ = Inner
        return kernel

    return compile_


_PART: dict[str, Any] = {
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "_nrt": False,
}

part = _inner(**_PART)
views = _inner(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
inline = _inner(forceinline=True, **_PART)
inline_views = _inner(
    error_model="numpy",
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
    forceinline=True,
)
polynomial = _inner(fastmath={"contract"}, **_PART)


_usual_type: Any = _Function.get_call_type
_call_types: dict[Any, Any] = {}


def _call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """Return the signature of a call of a function of numba's, remembered.

    numba tries dozens of candidates for each sum. What it compiles for a call depends on more than
    the types, and is not remembered.
    """
    call = function, tuple(args), tuple(kws.items())
    found = _call_types.get(call)
    if found is None:
        found = _usual_type(function, context, args, kws)
        if function.get_impl_key(found) != function.typing_key:
            return found
        _call_types[call] = found
    function._impl_keys[found.args] = function.typing_key  # noqa: SLF001
    return found


class _CompilerClock(event.Listener):  # type: ignore[misc]
    """CPU time of this process while something is being compiled, s; inner parts count once.

    Meanwhile those who wait are told so, types of calls are remembered, and Python looks for no
    garbage: among the millions of objects that numba makes and keeps that takes a seventh of the
    time.
    """

    def __init__(self) -> None:
        self.total, self._since, self._depth = 0.0, 0.0, 0
        self._told = ExitStack()
        self._collects = False

    def on_start(self, event: Any) -> None:  # noqa: ARG002 (numba's signature)
        if self._depth == 0:
            self._since = time.process_time()
            self._told.enter_context(stage(_how_often()))
            self._collects = gc.isenabled()
            gc.disable()
            _Function.get_call_type = _call_type
        self._depth += 1

    def on_end(self, event: Any) -> None:  # noqa: ARG002
        self._depth -= 1
        if self._depth == 0:
            self.total += time.process_time() - self._since
            self._told.close()
            _Function.get_call_type = _usual_type
            if self._collects:
                gc.enable()


_compiler_clock = _CompilerClock()
_register: Any = event.register
_register(
    "numba:compile", _compiler_clock
)  # what Python calls is compiled on its first call


def compile_time() -> float:
    """CPU time that this process has spent on compiling, s; none on code from the store."""
    return _compiler_clock.total


@contextmanager
def timed_compilation() -> Iterator[None]:
    """Count what is done inside as compiling."""
    _compiler_clock.on_start(None)
    try:
        yield
    finally:
        _compiler_clock.on_end(None)


def store_folder(kind: str, content: bytes) -> str:
    """NUMBA_CACHE_DIR or the user's cache folder, and in it one for this content."""
    content += numba.__version__.encode()
    return f"{_root()}/{kind}-{hashlib.sha256(content).hexdigest()[:16]}"


def _root() -> str:
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
    return _settings.CACHE_DIR or f"{user}/squealpipe"


@cache
def _how_often() -> str:
    """Say whether what is compiled is kept for later runs; if not, why, and what to do."""
    variable = "NUMBA_CACHE_DIR" if _settings.CACHE_DIR else "XDG_CACHE_HOME"
    try:
        Path(_root()).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=_root()) as trial:
            trial.write(bytes(2**20))  # the size of some kernels
    except OSError as error:
        return f"compiling at every run ({error.strerror}: {_root()}; set {variable})"
    return "compiling, once on this machine"
