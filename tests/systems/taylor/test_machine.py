"""Machine code of written functions, and the store that keeps it."""

import ctypes
import errno
import os
from functools import cache

import llvmlite.binding
import numba
import numpy as np
import pytest
from llvmlite import ir
from numba.core import codegen
from numba.np import arrayobj

from squealpipe.systems.compiled import part
from squealpipe.systems.taylor import machine, one_module
from squealpipe.systems.taylor.writing import compile_source

SOURCE = """
def horner(values, count, out):
 total = 0.0
 for k in range(count - 1, -1, -1):
  total = total * 0.5 + number(values + 8 * k)
 put(out, total)
 return
"""


@pytest.fixture
def compiled(tmp_path, monkeypatch):
    """Compiles as a new process would, with a store of its own."""

    def value():
        monkeypatch.setattr(machine, "_addresses", {})
        monkeypatch.setattr(machine, "_engine", cache(machine._engine.__wrapped__))
        words = [ctypes.c_ssize_t] * 3
        function = ctypes.CFUNCTYPE(None, *words)(compile_source(SOURCE))
        values, out = np.array([1.0, -3.0, 5.0]), np.zeros(1)
        function(values.ctypes.data, len(values), out.ctypes.data)
        return out[0]

    monkeypatch.setattr(machine, "store_folder", lambda *_: str(tmp_path / "store"))
    return value


def files(tmp_path):
    return {path: path.read_bytes() for path in (tmp_path / "store").iterdir()}


def test_a_function_is_compiled_once_and_kept(compiled, tmp_path, monkeypatch):
    assert compiled() == 1.0 - 3.0 / 2 + 5.0 / 4
    kept = files(tmp_path)
    assert len(kept) == 1
    monkeypatch.setattr(machine, "_compiled", None)
    assert compiled() == 0.75
    assert files(tmp_path) == kept


@pytest.mark.parametrize("kept", [-100, 0])
def test_a_damaged_file_of_the_store_is_written_anew(compiled, tmp_path, kept):
    assert compiled() == 0.75
    ((path, whole),) = files(tmp_path).items()
    path.write_bytes(whole[:kept])
    assert compiled() == 0.75
    assert files(tmp_path) == {path: whole}


def test_the_store_is_readable_as_others_are_and_forgets_what_it_kept_first(
    compiled, tmp_path, monkeypatch
):
    (tmp_path / "another").write_text("")
    assert compiled() == 0.75
    ((path, whole),) = files(tmp_path).items()
    assert path.stat().st_mode == (tmp_path / "another").stat().st_mode
    old = path.with_name("old.o")
    old.write_bytes(whole)
    os.utime(old, (0, 0))
    path.unlink()
    monkeypatch.setattr(machine, "MOST", len(whole))
    monkeypatch.setattr(machine, "_stored_files", iter([1, 100]))
    assert compiled() == 0.75
    assert files(tmp_path) == {path: whole, old: whole}  # it looks now and then
    path.unlink()
    assert compiled() == 0.75
    assert files(tmp_path) == {path: whole}


def test_what_cannot_be_kept_leaves_no_file_behind(compiled, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "no space left")

    monkeypatch.setattr(machine.Path, "replace", full)
    assert compiled() == 0.75
    assert not files(tmp_path)


def test_without_a_place_to_write_it_is_compiled_in_memory(compiled, tmp_path):
    (tmp_path / "store").write_text("a file in the way")
    assert compiled() == 0.75


def test_what_a_loop_calls_is_compiled_with_it_alone_and_serves_other_code(
    tmp_path, monkeypatch
):
    @part
    def square(x):
        return x * x

    @part
    def cube(x):
        return square(x) * x

    monkeypatch.setattr(machine, "store_folder", lambda *_: str(tmp_path))
    optimize, optimized = codegen.JITCodeLibrary._optimize_final_module, []

    def counted(library):
        optimized.append(library.name)
        optimize(library)

    with monkeypatch.context() as within:
        within.setattr(codegen.JITCodeLibrary, "_optimize_final_module", counted)
        number = numba.float64
        address = machine.address_of_entry(lambda x: cube(x) + 1.0, number(number), b"")
    assert len(optimized) == 1
    assert ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(address)(3.0) == 28.0
    assert numba.njit(lambda x: cube(x) - 1.0)(3.0) == 26.0


def test_parts_read_and_write_arrays_as_python_does(monkeypatch):
    """They do without numba's structure of an array, which is made for them nowhere."""
    made, of_numba = [], arrayobj.make_array

    class Counted(one_module._Array):
        def __init__(self, *arguments, **named):
            made.append(arguments)
            super().__init__(*arguments, **named)

    @part
    def mix(a, b, i, j):
        row, tail, across = a[j], b[1:i], a.T
        a[i, -1] = row[-j] + tail[0] + across[i, j]
        a[0, :2] = b[-1]
        tail[j - i] += a.size + tail.nbytes + a.shape[1]
        total = 0.0
        for each in b:
            total += each
        return total + a[:, 1].strides[0] + across[2:, ::2].sum() + (row, 2)[1]

    @numba.njit
    def by_compiled_code(a, b, i, j):
        return mix(a, b, i, j)

    def arrays():
        return np.arange(12.0).reshape(3, 4), np.linspace(0.0, 2.0, 7) ** 2

    kinds = [numba.typeof(each) for each in (*arrays(), 1, 1)]
    with monkeypatch.context() as within:
        within.setattr(one_module, "_Array", Counted)
        within.setattr(arrayobj, "make_array", None)
        with one_module.only_written():
            mix.compile(tuple(kinds))
    assert len(made) > 20
    assert arrayobj.make_array is of_numba  # for whoever uses numba
    compiled, true = arrays(), arrays()
    assert by_compiled_code(*compiled, 2, 1) == mix.py_func(*true, 2, 1)
    np.testing.assert_array_equal(compiled[0], true[0])
    np.testing.assert_array_equal(compiled[1], true[1])


def test_parts_of_values_are_what_was_put_there():
    """A part beside another one, one of a whole that was put in, and a whole with a part."""
    word = ir.IntType(64)
    pair = ir.LiteralStructType([word, word])
    kind = ir.LiteralStructType([word, pair])
    function = ir.Function(ir.Module(), ir.FunctionType(word, [word, pair]), "parts")
    builder = ir.IRBuilder(function.append_basic_block())
    number, both = function.args
    with one_module.only_written():
        whole = builder.insert_value(ir.Constant(kind, None), both, 1)
        whole = builder.insert_value(whole, number, 0)
        assert builder.extract_value(whole, 0) is number
        assert builder.extract_value(whole, [1]) is both
        of_both = builder.extract_value(whole, [1, 0])
        changed = builder.insert_value(whole, of_both, [1, 1])
        assert builder.extract_value(changed, [1, 1]) is of_both
        mixed = builder.extract_value(changed, 1)
    assert of_both.opname == "extractvalue"
    assert (mixed.opname, mixed.aggregate) == ("extractvalue", changed)
    builder.ret(of_both)
    llvmlite.binding.parse_assembly(str(function.module)).verify()
