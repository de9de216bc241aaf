"""Machine code of functions that are called by their addresses, kept on disk.

Written code computes with rows of lanes already and says itself where it loops. What looks for
more to vectorize or to unroll takes three quarters of the time in vain: LLVM compiles it without.
Whole loops in Python are compiled by numba. Of both the object files are kept, and loaded by LLVM
alone: numba would import what it infers types by first, which takes a process 0.4 s.
"""

import hashlib
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any

import llvmlite.binding
import numba
from llvmlite import __version__ as llvmlite_version
from llvmlite import ir
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.core.runtime.nrt import rtsys

from squealpipe.systems.compiled import store_folder, timed_compilation
from squealpipe.systems.taylor.one_module import compile_entries

_llvm: Any = llvmlite.binding
_config: Any = numba.config
_only_one_thread: Any = global_compiler_lock
_cpu_target: Any = cpu_target
_runtime: Any = rtsys
LEVEL = 2
"""Level of LLVM's optimization."""
MOST = 2**28
"""Bytes of code that the store keeps."""
Write = Callable[[Any, Sequence[Any]], None]


@cache
def _processor() -> tuple[str, str, str]:
    """Return target, name and features of the processor, as numba takes it."""
    found: tuple[str, str, str] = _cpu_target.target_context.codegen().magic_tuple()
    return found


def _machine() -> Any:
    triple, name, features = _processor()
    target = _llvm.Target.from_triple(triple)
    return target.create_target_machine(
        cpu=name,
        features=features,
        opt=LEVEL,
        reloc="static" if target.name.startswith("x86") else "default",
        codemodel="jitdefault",
        jit=True,
    )


@cache
def _engine() -> Any:
    """Return the engine that code is loaded into; it stays as long as the process."""
    # code that numba compiles calls its runtime: LLVM ends a process that lacks such a name
    _runtime.initialize(_cpu_target.target_context)
    return _llvm.create_mcjit_compiler(
        _llvm.parse_assembly(""),
        _machine(),
        use_lmm=_config.USE_LLVMLITE_MEMORY_MANAGER,
    )


def address_of(write: Write, n_arguments: int, content: bytes) -> int:
    """Return the address of a function of addresses and sizes, compiled or taken from the store.

    Args:
        write: writes its body, for a builder and the arguments.
        content: all that decides what ``write`` writes.
    """
    found = _addresses_of(content, lambda name: _compiled(name, write, n_arguments))
    return found[0]


def address_of_entry(
    function: Callable[..., Any],
    signature: Any,
    content: bytes,
    *,
    vectorize: bool = True,
) -> int:
    """Return the address of a C function as :func:`addresses_of_entries` does."""
    entries = [(function, signature)]
    return addresses_of_entries(entries, content, vectorize=vectorize)[0]


def addresses_of_entries(
    entries: Sequence[tuple[Callable[..., Any], Any]],
    content: bytes,
    *,
    vectorize: bool = True,
) -> list[int]:
    """Return the addresses of C functions that numba writes, compiled or taken from the store.

    Args:
        entries: functions and their signatures.
        content: all sources that the functions are made of.
        vectorize: let LLVM look for loops over numbers side by side.
    """
    names = [f"{each.__module__}.{each.__qualname__}{kind}" for each, kind in entries]
    return _addresses_of(
        "".join(names).encode() + content,
        lambda _: compile_entries(entries, vectorize=vectorize),
    )


_Compile = Callable[[str], tuple[list[str], bytes]]


def _addresses_of(content: bytes, compile_: _Compile) -> list[int]:
    """Return the addresses of functions that are made of some content."""
    versions = f"{llvmlite_version}{LEVEL}{_processor()}"
    content = versions.encode() + Path(__file__).read_bytes() + content
    addresses: list[int] = _loaded(hashlib.sha256(content).hexdigest(), compile_)
    return addresses


_addresses: dict[str, list[int]] = {}


@_only_one_thread  # type: ignore[untyped-decorator]
def _loaded(digest: str, compile_: _Compile) -> list[int]:
    """Return the addresses of functions, by a digest that names them."""
    if digest not in _addresses:
        path = Path(store_folder("written", b"")) / f"{digest}.o"
        stored = _kept(path)
        if stored is None:
            with timed_compilation():
                names, code = compile_(f"written_{digest}")
            _keep(path, "\n".join(names).encode() + b"\0" + code)
        else:
            encoded, _, code = stored.partition(b"\0")
            names = encoded.decode().split("\n")
        engine = _engine()
        engine.add_object_file(_llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        _addresses[digest] = [engine.get_function_address(name) for name in names]
    return _addresses[digest]


def _compiled(name: str, write: Write, n_arguments: int) -> tuple[list[str], bytes]:
    """Return name and object file of one function."""
    machine = _machine()
    module = ir.Module(name)
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    word = ir.IntType(64)
    kind = ir.FunctionType(ir.VoidType(), [word] * n_arguments)
    function = ir.Function(module, kind, name)
    # rows that registers do not hold would lie across lines of the cache, or pages, else
    function.attributes.alignstack = 64
    function.attributes.add("nounwind")  # without another one llvmlite writes none
    builder: Any = ir.IRBuilder(function.append_basic_block())
    write(builder, function.args)
    builder.ret_void()
    parsed = _llvm.parse_assembly(str(module))
    parsed.verify()
    tuning = _llvm.create_pipeline_tuning_options(speed_level=LEVEL)
    tuning.loop_vectorization = tuning.slp_vectorization = False
    tuning.loop_unrolling = tuning.loop_interleaving = False
    passes = _llvm.create_pass_builder(machine, tuning)
    passes.getModulePassManager().run(parsed, passes)
    return [name], machine.emit_object(parsed)


def _kept(path: Path) -> bytes | None:
    """Return code from the store, if it is whole."""
    with suppress(OSError):
        stored = path.read_bytes()
        seal, code = stored[:32], stored[32:]
        if seal == hashlib.sha256(code).digest():
            return code
    return None


_stored_files = count()
"""Numbers of the files that this process stores."""


def _keep(path: Path, code: bytes) -> None:
    """Store code where it can be written; beyond the store's size what was written first goes."""
    part = path.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            part.write_bytes(hashlib.sha256(code).digest() + code)
            part.replace(path)
        finally:  # a full disk, say, leaves no part of a file behind
            part.unlink(missing_ok=True)
        # a full store has 20,000 files, which take 0.5 s to look through
        if next(_stored_files) % 100 == 0:
            held = 0
            files = path.parent.glob("*.o")
            for old in sorted(files, key=lambda file: -file.stat().st_mtime_ns):
                held += old.stat().st_size
                if held > MOST:
                    old.unlink(missing_ok=True)
