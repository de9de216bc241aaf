"""Compile functions of numba that call one another as one module of LLVM.

Idea: numba optimizes every function by itself and makes machine code of it, which nobody runs, then
links it into each that calls it and does the same again there: a tree of calls is compiled once a
level. Here numba writes LLVM's code only; what a loop calls is linked once, optimized once with
numba's own passes, and compiled.
Source: numba's pull request 9566, which proposes the same for functions that Python does not call.
A part that is taken of an array is what was put there before, which numba has LLVM find out.
Invariant: what was written for a loop can be linked into other code that numba compiles, too; the
results are the same to the last bit.
Cost: of what is left a third each is LLVM's and for writing LLVM's code, a tenth for types.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, cached_property, partial
from typing import Any

import llvmlite.binding
import numba
from llvmlite import ir
from llvmlite.binding import Linkage
from llvmlite.ir import instructions
from numba.core import codegen, postproc, transforms
from numba.core.registry import cpu_target
from numba.np import arrayobj

from squealpipe.systems.compiled import KernelCompiler

_numba: Any = numba
_config: Any = numba.config
_Library: Any = codegen.JITCodeLibrary
_Codegen: Any = codegen.JITCPUCodegen
_target: Any = cpu_target
_arrays: Any = arrayobj
_llvm: Any = llvmlite.binding
_InsertValue: Any = instructions.InsertValue
_PostProcessor: Any = postproc.PostProcessor
_Lifetimes: Any = postproc.VariableLifetime
_canonical: Any = transforms.canonicalize_cfg


class _Part(_Library):  # type: ignore[misc]
    """Code of a function that is optimized and compiled only in what calls it."""

    _shared_module: Any

    def add_ir_module(self, ir_module: Any) -> None:
        """Add code that numba wrote, without the arrays of which only parts are needed."""
        for function in ir_module.functions:
            needed: set[int] = set()
            for block in reversed(function.blocks):
                kept = []
                for each in reversed(block.instructions):
                    if id(each) in needed or not isinstance(each, _InsertValue):
                        needed.update(map(id, each.operands))
                        kept.append(each)
                block.instructions[:] = reversed(kept)
        super().add_ir_module(ir_module)

    def _optimize_functions(self, ll_module: Any) -> None:
        """Do what numba does, which builds LLVM's passes anew for each function that is named."""
        ll_module.data_layout = self._codegen._data_layout  # noqa: SLF001
        for function in ll_module.functions:
            if not function.is_declaration:
                passes, builder = self._codegen.function_passes
                passes.run(function, builder)

    def finalize(self) -> None:
        """Let several that call it be linked to one another."""
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == Linkage.external:
                function.linkage = "linkonce_odr"
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:  # noqa: ARG002 (numba's name)
        """Return no address, as numba does where a function has no wrapper for Python."""
        return 0

    def _get_module_for_linking(self) -> Any:
        """Return the code with all that it calls."""
        if self._shared_module is None:
            module = self._final_module.clone()
            called, linked = [*self._linking_libraries], {self}
            for library in called:  # which grows
                if library in linked:
                    continue
                linked.add(library)
                if isinstance(library, _Part):
                    called += library._linking_libraries  # noqa: SLF001
                    code = library._final_module  # noqa: SLF001
                else:
                    code = library._get_module_for_linking()  # noqa: SLF001
                module.link_in(code, preserve=True)
            self._shared_module = module
        return self._shared_module


class _Parts(_Codegen):  # type: ignore[misc]
    """Generator of such code."""

    _library_class = _Part
    vectorizes = True

    @cached_property
    def function_passes(self) -> Any:
        """LLVM's passes over one function."""
        return self._function_pass_manager()

    def set_env(self, env_name: str, env: Any) -> None:
        """Do nothing: code without Python's objects needs no environment."""

    def _pass_builder(
        self,
        opt: Any = _config.OPT,
        loop_vectorize: Any = _config.LOOP_VECTORIZE,
        slp_vectorize: Any = _config.SLP_VECTORIZE,
    ) -> Any:
        """Return what numba optimizes with, but unroll no loops.

        That took a third of LLVM's time and made code half as long again, which is no faster.
        """
        tuning = _llvm.create_pipeline_tuning_options(opt)
        tuning.loop_vectorization = loop_vectorize and self.vectorizes
        tuning.slp_vectorization = slp_vectorize
        tuning.loop_unrolling = False
        return _llvm.create_pass_builder(self._tm, tuning)

    def compiled(self, library: _Part, names: Sequence[str]) -> bytes:
        """Return the object file of some functions with all that they call."""
        library._final_module = library._get_module_for_linking()  # noqa: SLF001
        for name in names:
            library.get_function(name).linkage = "external"
        library._optimize_final_module()  # noqa: SLF001
        code: bytes = self._tm.emit_object(library._final_module)  # noqa: SLF001
        return code


@cache
def _parts() -> _Parts:
    return _Parts("parts")


class _Array:
    """Fields of an array, read from its value and written into it.

    numba's own puts the value on the stack wherever one of its fields is needed, for LLVM to take
    it from there again, and looks in vain for a conversion each time: a third of what it writes.
    """

    def __init__(
        self, kind: Any, context: Any, builder: Any, value: Any = None
    ) -> None:
        model = context.data_model_manager[kind]
        if value is None:
            value = ir.Constant(model.get_value_type(), None)
        vars(self).update(
            _context=context, _builder=builder, _datamodel=model, _value=value
        )

    def __getattr__(self, name: str) -> Any:
        return self._datamodel.get(self._builder, self._value, name)

    def __setattr__(self, name: str, field: Any) -> None:
        changed = self._datamodel.set(self._builder, self._value, field, name)
        vars(self)["_value"] = changed

    def _getvalue(self) -> Any:
        return self._value


_usual_extract: Any = ir.IRBuilder.extract_value


def _part_of(builder: Any, whole: Any, place: Any, name: str = "") -> Any:
    """Return a part of a value, as it was put there if that is known."""
    path = list(place) if isinstance(place, tuple | list) else [place]
    while isinstance(whole, _InsertValue):
        put = list(whole.indices)
        if put == path:
            return whole.value
        # one that was put beside this part; not around or into it
        if put[: len(path)] == path or path[: len(put)] == put:
            break
        whole = whole.aggregate
    return _usual_extract(builder, whole, path, name)


_usual_run: Any = _PostProcessor.run


def _order_blocks(processor: Any, emit_dels: bool = False, **options: Any) -> None:
    """Order blocks as numba does after each pass, which notes where variables end for nobody."""
    code = processor.func_ir
    if emit_dels or code.is_generator:
        _usual_run(processor, emit_dels, **options)
        return
    code.blocks = _canonical(code.blocks)
    code.variable_lifetime = _Lifetimes(code.blocks)  # looks when it is asked
    code.generator_info = None


@cache
def _size(kind: Any) -> int:
    """Return the bytes of a type; llvmlite writes and reads a module for each question."""
    size: int = kind.get_abi_size(_target.target_context.target_data)
    return size


@contextmanager
def only_written() -> Iterator[None]:
    """Let numba compile nothing of what it writes meanwhile."""
    context = _target.target_context
    usual, usual_array = context.codegen(), _arrays.make_array
    context._internal_codegen = _parts()  # noqa: SLF001 (has no public setter)
    context.get_abi_sizeof = _size
    _arrays.make_array = partial(partial, _Array)
    ir.IRBuilder.extract_value = _part_of
    _PostProcessor.run = _order_blocks
    try:
        yield
    finally:
        context._internal_codegen = usual  # noqa: SLF001
        del context.get_abi_sizeof
        _arrays.make_array = usual_array
        ir.IRBuilder.extract_value = _usual_extract
        _PostProcessor.run = _usual_run


def compile_entries(
    entries: Sequence[tuple[Callable[..., Any], Any]], *, vectorize: bool
) -> tuple[list[str], bytes]:
    """Return the names and the object file of C functions that numba writes.

    The caller holds numba's lock.

    Args:
        entries: functions and their signatures.
        vectorize: let LLVM look for loops over numbers side by side.
    """
    _parts().vectorizes = vectorize
    with only_written():
        written = [
            _numba.cfunc(signature, error_model="numpy", pipeline_class=KernelCompiler)(
                function
            )
            for function, signature in entries
        ]
    names = [entry.native_name for entry in written]
    library, *others = (entry._library for entry in written)  # noqa: SLF001 (numba's store reads it)
    library._linking_libraries += others  # noqa: SLF001
    return names, _parts().compiled(library, names)
