"""One number per lane: vectors of doubles inside compiled code.

A compiled function loads a row of ``LANES`` contiguous doubles as one value, computes with it as
with a float, and stores it; code of :mod:`squealpipe.systems.taylor.writing` may load its first
``FEW``. LLVM maps each operation onto what the processor has (a row onto two AVX-512 or four AVX2
registers). Sums, products, quotients, square roots and fused products are rounded as IEEE 754 says,
and lanes never mix: such results depend neither on the lane nor on the processor. Exponentials,
logarithms, powers and functions of angles are those of the C library, to its last digit.
"""

import operator
from collections.abc import Callable
from functools import partial
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing import templates
from numba.extending import intrinsic, lower_builtin, models, register_model

LANES = 16
"""Lanes of a batch: two registers of AVX-512; the last digits do not depend on it."""
FEW = 4
"""Lanes that a batch of no more runs needs: one register of AVX2. Rows keep their size."""
ROW = 8 * LANES
"""Bytes of one row; rows start at multiples of ``ALIGNMENT``."""
ALIGNMENT = 64

_cgutils: Any = cgutils
_Type: Any = types.Type
ConcreteTemplate: Any = templates.ConcreteTemplate
infer_global: Any = templates.infer_global
signature: Any = templates.signature
_lower_builtin: Any = lower_builtin


def doubles(width: int) -> Any:
    """LLVM's type of a vector."""
    return ir.VectorType(ir.DoubleType(), width)


class _Lanes(_Type):  # type: ignore[misc]
    """numba's type of a vector."""

    def __init__(self) -> None:
        super().__init__(name="lanes")


lanes = _Lanes()
_PrimitiveModel: Any = models.PrimitiveModel


@register_model(_Lanes)
class _Model(_PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, doubles(LANES))


def _intrinsic(
    result: Any, arguments: tuple[Any, ...], generate: Callable[..., Any]
) -> Any:
    """A function of compiled code from ``generate(builder, *values) -> value``."""

    def typing(context: Any, *given: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            made = generate(builder, *values)
            return context.get_dummy_value() if result is types.void else made

        return result(*arguments), code

    names = ", ".join("abcdef"[: len(arguments)])
    scope: dict[str, Any] = {"typing": typing}
    exec(f"def function(context, {names}): return typing(context, {names})", scope)  # noqa: S102
    return intrinsic(scope["function"])


def _pointer(builder: Any, address: Any, kind: Any) -> Any:
    return builder.inttoptr(address, kind.as_pointer())


def _load(builder: Any, address: Any, width: int = LANES) -> Any:
    row = builder.load(_pointer(builder, address, doubles(width)))
    row.align = min(ALIGNMENT, 8 * width)
    return row


def _store(builder: Any, address: Any, row: Any) -> None:
    stored = builder.store(row, _pointer(builder, address, row.type))
    stored.align = min(ALIGNMENT, 8 * row.type.count)


def _number(builder: Any, address: Any) -> Any:
    return builder.load(_pointer(builder, address, ir.DoubleType()))


def _whole(builder: Any, address: Any) -> Any:
    return builder.load(_pointer(builder, address, ir.IntType(64)))


def _table(builder: Any, *values: Any) -> Any:
    """The address of constants of one type."""
    kind = ir.ArrayType(values[0].type, len(values))
    table = _cgutils.global_constant(builder, "table", ir.Constant(kind, values))
    return builder.ptrtoint(table, ir.IntType(64))


def _space(builder: Any, count: Any) -> Any:
    """The address of room for some numbers, as long as the function runs."""
    kind = ir.ArrayType(ir.DoubleType(), count.constant)
    return builder.ptrtoint(_cgutils.alloca_once(builder, kind), ir.IntType(64))


def _put(builder: Any, address: Any, value: Any) -> None:
    builder.store(value, _pointer(builder, address, ir.DoubleType()))


def _splat(builder: Any, value: Any, width: int = LANES) -> Any:
    undefined = ir.Constant(doubles(width), ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), width), None)
    return builder.shuffle_vector(first, undefined, zeros)


def _called(name: str) -> Callable[..., Any]:
    """A function of LLVM's own, lane by lane."""

    def generate(builder: Any, *values: Any) -> Any:
        row = values[0].type
        kind = ir.FunctionType(row, [row] * len(values))
        lanes_of = f"v{row.count}" if isinstance(row, ir.VectorType) else ""
        name_of_width = f"llvm.{name}.{lanes_of}f64"
        function = _cgutils.get_or_insert_function(builder.module, kind, name_of_width)
        return builder.call(function, values)

    return generate


def _of_libm(name: str) -> Callable[..., Any]:
    """A function of the C library, one lane after the other."""

    def generate(builder: Any, value: Any) -> Any:
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double])
        function = _cgutils.get_or_insert_function(builder.module, kind, name)
        if not isinstance(value.type, ir.VectorType):
            return builder.call(function, [value])
        row = value
        for lane in range(value.type.count):
            place = ir.Constant(ir.IntType(32), lane)
            number = builder.call(function, [builder.extract_element(value, place)])
            row = builder.insert_element(row, number, place)
        return row

    return generate


def _bits_below(builder: Any, first: Any, second: Any) -> Any:
    below = builder.fcmp_ordered("<", first, second)
    return builder.zext(
        builder.bitcast(below, ir.IntType(below.type.count)), ir.IntType(64)
    )


def _choose_below(
    builder: Any, first: Any, second: Any, then: Any, otherwise: Any
) -> Any:
    return builder.select(builder.fcmp_ordered("<", first, second), then, otherwise)


def _choose(builder: Any, bits: Any, then: Any, otherwise: Any) -> Any:
    word = builder.trunc(bits, ir.IntType(LANES))
    mask = builder.bitcast(word, ir.VectorType(ir.IntType(1), LANES))
    return builder.select(mask, then, otherwise)


def _only(builder: Any, mark: Any, value: Any) -> Any:
    """A value where a mark is above zero, else zero (also for NaN)."""
    zero = ir.Constant(mark.type, None)
    return _choose_below(builder, zero, mark, value, zero)


def _larger(builder: Any, first: Any, second: Any) -> Any:
    return _choose_below(builder, second, first, first, second)


def _power(builder: Any, value: Any, exponent: Any) -> Any:
    """value ** exponent to about 1 %, from the bits of a positive normal number."""
    rows, words = value.type, ir.VectorType(ir.IntType(64), LANES)

    def word(each: int) -> Any:
        return ir.Constant(words, [each] * LANES)

    def double(each: float) -> Any:
        return ir.Constant(rows, [each] * LANES)

    high = builder.lshr(builder.bitcast(value, words), word(32))
    # Its last 52 bits count in ones: integers become doubles, and back, by one
    # addition.
    shift = 2.0**52
    high = builder.or_(high, builder.bitcast(double(shift), words))
    units = builder.fsub(builder.bitcast(high, rows), double(shift))
    mantissa_log = builder.fsub(builder.fmul(units, double(2.0**-20)), double(1023.0))
    power = builder.fmul(mantissa_log, exponent)
    whole = _called("floor")(builder, power)
    part = builder.fsub(power, whole)
    curve = builder.fadd(builder.fmul(part, double(0.3431)), double(0.6569))
    curve = builder.fadd(builder.fmul(part, curve), double(1.0))
    shifted = builder.bitcast(builder.fadd(whole, double(shift + 1023.0)), words)
    scale = builder.bitcast(builder.shl(shifted, word(52)), rows)
    return builder.fmul(curve, scale)


first_bit: Any = _intrinsic(
    types.int64,
    (types.int64,),
    lambda builder, bits: builder.cttz(bits, ir.Constant(ir.IntType(1), 0)),
)
"""Position of the lowest bit that is set."""
load: Any = _intrinsic(lanes, (types.intp,), _load)
"""The row at an address."""
word: Any = _intrinsic(types.int64, (types.intp,), _whole)
"""The integer at an address."""
number: Any = _intrinsic(types.float64, (types.intp,), _number)
"""The number at an address."""
store: Any = _intrinsic(types.void, (types.intp, lanes), _store)
"""Write a row to an address."""
splat: Any = _intrinsic(lanes, (types.float64,), _splat)
"""Put one number into every lane."""
fma: Any = _intrinsic(lanes, (lanes, lanes, lanes), _called("fma"))
"""a b + c, rounded once."""
magnitude: Any = _intrinsic(lanes, (lanes,), _called("fabs"))
bits_below: Any = _intrinsic(types.int64, (lanes, lanes), _bits_below)
"""Bit i is set where a < b in lane i; never for NaN."""
choose_below: Any = _intrinsic(lanes, (lanes, lanes, lanes, lanes), _choose_below)
"""c where a < b, else d (also for NaN)."""
choose: Any = _intrinsic(lanes, (types.int64, lanes, lanes), _choose)
"""b in the lanes whose bit is set, else c."""
rough_power: Any = _intrinsic(lanes, (lanes, lanes), _power)
"""a ** b to about 1 %, for positive normal a: enough for a step size."""
larger: Any = _intrinsic(lanes, (lanes, lanes), _larger)
"""The larger of two, lane by lane; b where one is NaN."""
smaller: Any = _intrinsic(
    lanes, (lanes, lanes), lambda builder, a, b: _choose_below(builder, a, b, a, b)
)
"""The smaller of two, lane by lane; b where one is NaN."""


def written(width: int) -> dict[str, Any]:
    """Generator of each function of written code, by its name there."""
    of_llvm = ("fma", "exp", "log", "sin", "cos", "pow", "copysign")
    of_libm = ("tanh", "sinh", "cosh", "atan", "asin")
    return {
        **{name: _called(name) for name in of_llvm},
        "bits_below": _bits_below,
        "root": _called("sqrt"),
        "abs": _called("fabs"),
        **{name: _of_libm(name) for name in of_libm},
        "min": lambda builder, a, b: _choose_below(builder, b, a, b, a),
        "put": _put,
        "load": partial(_load, width=width),
        "splat": partial(_splat, width=width),
        "store": _store,
        "number": _number,
        "whole": _whole,
        "table": _table,
        "space": _space,
        "larger": _larger,
        "only": _only,
        "smaller": lambda builder, a, b: _choose_below(builder, a, b, a, b),
    }


def _operate(symbol: Any, instruction: str) -> None:
    """An operator between rows, and between a row and a number."""
    number_kind = types.float64
    cases = [
        (lanes, *case)
        for case in ((lanes, lanes), (lanes, number_kind), (number_kind, lanes))
    ]

    class Typing(ConcreteTemplate):  # type: ignore[misc]
        pass

    Typing.cases = [signature(*case) for case in cases]
    register: Any = infer_global(symbol)
    register(Typing)

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:
        rows = [
            value if kind is lanes else _splat(builder, value)
            for kind, value in zip(sig.args, values, strict=True)
        ]
        return getattr(builder, instruction)(*rows)

    for _, *case in cases:
        register = _lower_builtin(symbol, *case)
        register(lower)


_operate(operator.add, "fadd")
_operate(operator.sub, "fsub")
_operate(operator.mul, "fmul")
_operate(operator.truediv, "fdiv")
