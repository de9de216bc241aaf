"""One number per lane: vectors of doubles inside compiled code.

A compiled function loads a row of ``LANES`` contiguous doubles, or its first ``FEW``, as one value,
computes with it as with a float, and stores it. LLVM maps each operation onto what the processor
has (a row onto two AVX-512 or four AVX2 registers). All operations are exact to the last bit as
IEEE 754 defines them and lanes never mix, so a result depends neither on the lane nor on the
processor.
"""

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


class _Lanes(_Type):  # type: ignore[misc]
    """numba's type of a vector."""

    def __init__(self, width: int) -> None:
        super().__init__(name=f"lanes({width})")
        self.doubles = ir.VectorType(ir.DoubleType(), width)


lanes = _Lanes(LANES)
few_lanes = _Lanes(FEW)
_PrimitiveModel: Any = models.PrimitiveModel


@register_model(_Lanes)
class _Model(_PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, kind.doubles)


def _intrinsic(result: Any, arguments: tuple[Any, ...], generate: Callable[..., Any]) -> Any:
    """A function of compiled code from ``generate(builder, *values) -> value``.

    Where it takes ``lanes`` it takes vectors of any width, and returns the same.
    """

    def typing(context: Any, *given: Any) -> Any:  # noqa: ARG001
        width = next((kind for kind in given if isinstance(kind, _Lanes)), lanes)
        kinds = [width if kind is lanes else kind for kind in (result, *arguments)]

        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
            made = generate(builder, *values)
            return context.get_dummy_value() if result is types.void else made

        return kinds[0](*kinds[1:]), code

    names = ", ".join("abcdef"[: len(arguments)])
    scope: dict[str, Any] = {"typing": typing}
    exec(f"def function(context, {names}): return typing(context, {names})", scope)  # noqa: S102
    return intrinsic(scope["function"])


def _pointer(builder: Any, address: Any, kind: Any) -> Any:
    return builder.inttoptr(address, kind.as_pointer())


def _loads(kind: _Lanes) -> Any:
    def generate(builder: Any, address: Any) -> Any:
        row = builder.load(_pointer(builder, address, kind.doubles))
        row.align = min(ALIGNMENT, 8 * kind.doubles.count)
        return row

    return _intrinsic(kind, (types.intp,), generate)


def _store(builder: Any, address: Any, row: Any) -> None:
    stored = builder.store(row, _pointer(builder, address, row.type))
    stored.align = min(ALIGNMENT, 8 * row.type.count)


def _number(builder: Any, address: Any) -> Any:
    return builder.load(_pointer(builder, address, ir.DoubleType()))


def _put(builder: Any, address: Any, value: Any) -> None:
    builder.store(value, _pointer(builder, address, ir.DoubleType()))


def _repeated(builder: Any, value: Any, doubles: Any) -> Any:
    undefined = ir.Constant(doubles, ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), doubles.count), None)
    return builder.shuffle_vector(first, undefined, zeros)


def _splats(kind: _Lanes) -> Any:
    return _intrinsic(
        kind, (types.float64,), lambda builder, value: _repeated(builder, value, kind.doubles)
    )


def _called(name: str) -> Callable[..., Any]:
    """A function of LLVM's own, lane by lane."""

    def generate(builder: Any, *values: Any) -> Any:
        doubles = values[0].type
        kind = ir.FunctionType(doubles, [doubles] * len(values))
        name_of_width = f"llvm.{name}.v{doubles.count}f64"
        function = _cgutils.get_or_insert_function(builder.module, kind, name_of_width)
        return builder.call(function, values)

    return generate


def _bits_below(builder: Any, first: Any, second: Any) -> Any:
    below = builder.fcmp_ordered("<", first, second)
    return builder.zext(builder.bitcast(below, ir.IntType(below.type.count)), ir.IntType(64))


def _choose_below(builder: Any, first: Any, second: Any, then: Any, otherwise: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", first, second), then, otherwise)


_SHIFT = 2.0**52
"""Its last 52 bits count in ones: integers become doubles, and back, by one addition."""


def _power(builder: Any, value: Any, exponent: Any) -> Any:
    """value ** exponent to about 1 %, from the bits of a positive normal number."""
    doubles = value.type
    words = ir.VectorType(ir.IntType(64), doubles.count)

    def word(each: int) -> Any:
        return ir.Constant(words, [each] * doubles.count)

    def double(each: float) -> Any:
        return ir.Constant(doubles, [each] * doubles.count)

    high = builder.lshr(builder.bitcast(value, words), word(32))
    high = builder.or_(high, builder.bitcast(double(_SHIFT), words))
    units = builder.fsub(builder.bitcast(high, doubles), double(_SHIFT))
    mantissa_log = builder.fsub(builder.fmul(units, double(2.0**-20)), double(1023.0))
    power = builder.fmul(mantissa_log, exponent)
    whole = _called("floor")(builder, power)
    part = builder.fsub(power, whole)
    curve = builder.fadd(builder.fmul(part, double(0.3431)), double(0.6569))
    curve = builder.fadd(builder.fmul(part, curve), double(1.0))
    shifted = builder.bitcast(builder.fadd(whole, double(_SHIFT + 1023.0)), words)
    scale = builder.bitcast(builder.shl(shifted, word(52)), doubles)
    return builder.fmul(curve, scale)


first_bit: Any = _intrinsic(
    types.int64,
    (types.int64,),
    lambda builder, bits: builder.cttz(bits, ir.Constant(ir.IntType(1), 0)),
)
"""Position of the lowest bit that is set."""
load: Any = _loads(lanes)
"""The row at an address."""
load_few: Any = _loads(few_lanes)
"""The first ``FEW`` numbers of the row at an address."""
store: Any = _intrinsic(types.void, (types.intp, lanes), _store)
"""Write a row to an address."""
splat: Any = _splats(lanes)
"""The same number in each lane."""
splat_few: Any = _splats(few_lanes)
"""The same number in each of ``FEW`` lanes."""
put: Any = _intrinsic(types.void, (types.intp, types.float64), _put)
"""Write one double to an address."""
number: Any = _intrinsic(types.float64, (types.intp,), _number)
"""The one double at an address."""
fma: Any = _intrinsic(lanes, (lanes, lanes, lanes), _called("fma"))
"""a b + c, rounded once."""
root: Any = _intrinsic(lanes, (lanes,), _called("sqrt"))
exponential: Any = _intrinsic(lanes, (lanes,), _called("exp"))
logarithm: Any = _intrinsic(lanes, (lanes,), _called("log"))
sine: Any = _intrinsic(lanes, (lanes,), _called("sin"))
cosine: Any = _intrinsic(lanes, (lanes,), _called("cos"))
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
    cases = [
        (kind, *case)
        for kind in (lanes, few_lanes)
        for case in ((kind, kind), (kind, number_kind), (number_kind, kind))
    ]

    class Typing(ConcreteTemplate):  # type: ignore[misc]
        pass

    Typing.cases = [signature(*case) for case in cases]
    register: Any = infer_global(symbol)
    register(Typing)

    def lower(context: Any, builder: Any, sig: Any, values: Any) -> Any:  # noqa: ARG001
        doubles = sig.return_type.doubles
        rows = [
            value if isinstance(kind, _Lanes) else _repeated(builder, value, doubles)
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
