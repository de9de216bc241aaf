"""Arrays at the addresses of a table, as attributes of one value of compiled code.

Idea: a function that is passed fifty arrays has four hundred arguments, which numba packs, and LLVM
unpacks, at each call. Here it is passed the address of a table of addresses and sizes, and an array
is made of these where it is used.
Invariant: compiled code writes into no table, so that LLVM may keep what it has read from one.
"""

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing import templates
from numba.extending import intrinsic, lower_getattr_generic, models, register_model
from numba.np import arrayobj

from squealpipe.systems.taylor import layout

_Type: Any = types.Type
_PrimitiveModel: Any = models.PrimitiveModel
_AttributeTemplate: Any = templates.AttributeTemplate
_infer_getattr: Any = templates.infer_getattr
_lower: Any = lower_getattr_generic
_arrays: Any = arrayobj
_cgutils: Any = cgutils
_word = ir.IntType(64)


class _Table(_Type):  # type: ignore[misc]
    """Type of the address of a table."""

    def __init__(self, name: str, record: np.dtype, arrays: Mapping[str, Any]) -> None:
        super().__init__(name=name)
        self.fields, self.arrays = list(record.names or ()), arrays

    def kind(self, name: str) -> Any:
        """Return numba's type of a field: an array that has a shape, or an integer."""
        if not self.arrays.get(name):
            return types.int64
        element, *shape = self.arrays[name]
        scalar = {"f8": types.float64, "i8": types.int64}[element]
        return types.Array(scalar, len(shape), "C")


@register_model(_Table)
class _Model(_PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _word.as_pointer())


@_infer_getattr
class _Attributes(_AttributeTemplate):  # type: ignore[misc]
    key = _Table

    def generic_resolve(self, table: _Table, name: str) -> Any:
        return table.kind(name) if name in table.fields else None


def contiguous(
    context: Any, builder: Any, kind: Any, address: Any, shape: list[Any]
) -> Any:
    """Write the code that makes an array of its address and shape."""
    itemsize = context.get_abi_sizeof(context.get_data_type(kind.dtype))
    strides = [ir.Constant(_word, itemsize)]
    for dimension in shape[:0:-1]:
        strides.insert(0, builder.mul(dimension, strides[0]))
    array: Any = _arrays.make_array(kind)(context, builder)
    data = builder.inttoptr(address, array.data.type)
    _arrays.populate_array(array, data, shape, strides, itemsize=itemsize, meminfo=None)
    return array._getvalue()  # noqa: SLF001 (numba's own code reads it so)


def _attribute(
    context: Any, builder: Any, table: _Table, address: Any, name: str
) -> Any:
    """Write the code that reads a field."""

    def number(field: str) -> Any:
        if field.isdigit():
            return ir.Constant(_word, int(field))
        place = ir.Constant(_word, table.fields.index(field))
        loaded = builder.load(builder.gep(address, [place]))
        loaded.set_metadata("invariant.load", builder.module.add_metadata([]))
        return loaded

    def size(dimension: str | int) -> Any:
        first, *others = map(number, str(dimension).split("+"))
        for other in others:
            first = builder.add(first, other)
        return first

    kind = table.kind(name)
    if kind is types.int64:
        return number(name)
    shape = [size(dimension) for dimension in table.arrays[name][1:]]
    return contiguous(context, builder, kind, number(name), shape)


_lower(_Table)(_attribute)


def table_viewer(name: str, record: np.dtype, arrays: Mapping[str, Any]) -> Any:
    """Return a compiled function that makes a table of an address.

    Args:
        record: 8-byte fields of the table.
        arrays: type of elements (f8 or i8) and shape by field; nothing of one that is read as an
            address. A dimension is a number, a field, or a sum of these as text.
    """
    table = _Table(name, record, arrays)

    def at(typing_context: Any, address: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            return builder.inttoptr(values[0], _word.as_pointer())

        return table(types.intp), generate

    return intrinsic(at)


def room(*shape: int) -> Any:
    """Return a compiled function that makes an array, which lasts as long as what calls it."""
    kind = types.Array(types.float64, len(shape), "C")

    def at(typing_context: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            row = ir.ArrayType(ir.DoubleType(), prod(shape))
            array: Any = _arrays.make_array(kind)(context, builder)
            data = builder.bitcast(_cgutils.alloca_once(builder, row), array.data.type)
            sizes = [ir.Constant(_word, size) for size in shape]
            strides = [
                ir.Constant(_word, 8 * prod(shape[axis + 1 :]))
                for axis in range(len(shape))
            ]
            _arrays.populate_array(
                array, data, sizes, strides, itemsize=8, meminfo=None
            )
            return array._getvalue()  # noqa: SLF001

        return kind(), generate

    return intrinsic(at)


memory_at: Any = table_viewer("memory", layout.LOOP_TABLE, layout.LOOP_ARRAYS)
