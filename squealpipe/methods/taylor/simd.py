"""One number per lane: vectors of ``LANES`` doubles inside compiled code.

A compiled function loads a row of ``LANES`` contiguous doubles as one value, computes with it as
with a float, and stores it. LLVM maps each operation onto what the processor has (two AVX-512 or
four AVX2 registers). All operations are exact to the last bit as IEEE 754 defines them and lanes
never mix, so a result depends neither on the lane nor on the processor.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing import templates
from numba.extending import intrinsic, lower_builtin, models, register_model

LANES = 16
"""Lanes of a batch: two registers of AVX-512; the last digits do not depend on it."""
ROW = 8 * LANES
"""Bytes of one row; rows start at multiples of ``ALIGNMENT``."""
ALIGNMENT = 64

_DOUBLES: Any = ir.VectorType(ir.DoubleType(), LANES)
_WORDS: Any = ir.VectorType(ir.IntType(64), LANES)
_cgutils: Any = cgutils
_Type: Any = types.Type
ConcreteTemplate: Any = templates.ConcreteTemplate
infer_global: Any = templates.infer_global
signature: Any = templates.signature
_lower_builtin: Any = lower_builtin


class _Lanes(_Type):  # type: ignore[misc]
    """numba's type of a vector."""

    def __init__(self) -> None:
        super().__init__(name=f"lanes({LANES})")


lanes = _Lanes()
_PrimitiveModel: Any = models.PrimitiveModel


@register_model(_Lanes)
class _Model(_PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _DOUBLES)


def _intrinsic(result: Any, arguments: tuple[Any, ...], generate: Callable[..., Any]) -> Any:
    """A function of compiled code from ``generate(builder, *values) -> value``."""

    def typing(context: Any, *given: Any) -> Any:  # noqa: ARG001
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
            made = generate(builder, *values)
            return context.get_dummy_value() if result is types.void else made

        return result(*arguments), code

    names = ", ".join("abcdef"[: len(arguments)])
    scope: dict[str, Any] = {"typing": typing}
    exec(f"def function(context, {names}): return typing(context, {names})", scope)  # noqa: S102
    return intrinsic(scope["function"])


def _pointer(builder: Any, address: Any) -> Any:
    return builder.inttoptr(address, _DOUBLES.as_pointer())


def _load(builder: Any, address: Any) -> Any:
    row = builder.load(_pointer(builder, address))
    row.align = ALIGNMENT
    return row


def _store(builder: Any, address: Any, row: Any) -> None:
    builder.store(row, _pointer(builder, address)).align = ALIGNMENT


def _number(builder: Any, address: Any) -> Any:
    return builder.load(builder.inttoptr(address, ir.DoubleType().as_pointer()))


def _splat(builder: Any, value: Any) -> Any:
    undefined = ir.Constant(_DOUBLES, ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), None)
    return builder.shuffle_vector(first, undefined, zeros)


def _called(name: str) -> Callable[..., Any]:
    """A function of LLVM's own, lane by lane."""

    def generate(builder: Any, *values: Any) -> Any:
        kind = ir.FunctionType(_DOUBLES, [_DOUBLES] * len(values))
        function = _cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64")
        return builder.call(function, values)

    return generate


def _bits_below(builder: Any, first: Any, second: Any) -> Any:
    below = builder.fcmp_ordered("<", first, second)
    return builder.zext(builder.bitcast(below, ir.IntType(LANES)), ir.IntType(64))


def _choose_below(builder: Any, first: Any, second: Any, then: Any, otherwise: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", first, second), then, otherwise)


def _word(value: int) -> Any:
    return ir.Constant(_WORDS, [value] * LANES)


def _double(value: float) -> Any:
    return ir.Constant(_DOUBLES, [value] * LANES)


_SHIFT = 2.0**52
"""Its last 52 bits count in ones: integers become doubles, and back, by one addition."""


def _power(builder: Any, value: Any, exponent: Any) -> Any:
    """value ** exponent to about 1 %, from the bits of a positive normal number."""
    high = builder.lshr(builder.bitcast(value, _WORDS), _word(32))
    high = builder.or_(high, builder.bitcast(_double(_SHIFT), _WORDS))
    units = builder.fsub(builder.bitcast(high, _DOUBLES), _double(_SHIFT))
    mantissa_log = builder.fsub(builder.fmul(units, _double(2.0**-20)), _double(1023.0))
    power = builder.fmul(mantissa_log, exponent)
    whole = _called("floor")(builder, power)
    part = builder.fsub(power, whole)
    curve = builder.fadd(builder.fmul(part, _double(0.3431)), _double(0.6569))
    curve = builder.fadd(builder.fmul(part, curve), _double(1.0))
    shifted = builder.bitcast(builder.fadd(whole, _double(_SHIFT + 1023.0)), _WORDS)
    scale = builder.bitcast(builder.shl(shifted, _word(52)), _DOUBLES)
    return builder.fmul(curve, scale)


first_bit: Any = _intrinsic(
    types.int64,
    (types.int64,),
    lambda builder, bits: builder.cttz(bits, ir.Constant(ir.IntType(1), 0)),
)
"""Position of the lowest bit that is set."""
load: Any = _intrinsic(lanes, (types.intp,), _load)
"""The row at an address."""
store: Any = _intrinsic(types.void, (types.intp, lanes), _store)
"""Write a row to an address."""
splat: Any = _intrinsic(lanes, (types.float64,), _splat)
"""The same number in each lane."""
number: Any = _intrinsic(types.float64, (types.intp,), _number)
"""The one double at an address."""
fma: Any = _intrinsic(lanes, (lanes, lanes, lanes), _called("fma"))
"""a b + c, rounded once."""
root: Any = _intrinsic(lanes, (lanes,), _called("sqrt"))
exponential: Any = _intrinsic(lanes, (lanes,), _called("exp"))
magnitude: Any = _intrinsic(lanes, (lanes,), _called("fabs"))
bits_below: Any = _intrinsic(types.int64, (lanes, lanes), _bits_below)
"""Bit i is set where a < b in lane i; never for NaN."""
choose_below: Any = _intrinsic(lanes, (lanes, lanes, lanes, lanes), _choose_below)
"""c where a < b, else d (also for NaN)."""
rough_power: Any = _intrinsic(lanes, (lanes, lanes), _power)
"""a ** b to about 1 %, for positive normal a: enough for a step size."""
larger: Any = _intrinsic(
    lanes, (lanes, lanes), lambda builder, a, b: _choose_below(builder, b, a, a, b)
)
"""The larger of two, lane by lane; b where one is NaN."""
smaller: Any = _intrinsic(
    lanes, (lanes, lanes), lambda builder, a, b: _choose_below(builder, a, b, a, b)
)
"""The smaller of two, lane by lane; b where one is NaN."""


def _operate(symbol: Any, instruction: str) -> None:
    """An operator between rows, and between a row and a number."""
    number_kind = types.float64
    cases = [(lanes, lanes), (lanes, number_kind), (number_kind, lanes)]

    class Typing(ConcreteTemplate):  # type: ignore[misc]
        pass

    Typing.cases = [signature(lanes, *case) for case in cases]
    register: Any = infer_global(symbol)
    register(Typing)

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:  # noqa: ARG001
        rows = [
            value if kind is lanes else _splat(builder, value)
            for kind, value in zip(sig.args, values, strict=True)
        ]
        return getattr(builder, instruction)(*rows)

    for case in cases:
        register = _lower_builtin(symbol, *case)
        register(lower)


_operate(operator.add, "fadd")
_operate(operator.sub, "fsub")
_operate(operator.mul, "fmul")
_operate(operator.truediv, "fdiv")
