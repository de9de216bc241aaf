"""Compiled functions from source text over rows of doubles, written as LLVM's code at once.

The text is Python over addresses, numbers and rows: assignments, calls, loops over ranges, and one
branch. numba would compile it too, but takes ten times as long to find the types of its hundreds of
lines; here it compiles a call of what is written.
"""

import ast
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from squealpipe.methods.taylor.simd import written

_cgutils: Any = cgutils
_WORD, _DOUBLE = ir.IntType(64), ir.DoubleType()
_INTEGERS = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.FloorDiv: "sdiv", ast.Mod: "srem"}
"""Those of integers that are not negative."""
_DOUBLES = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}


def function_of(source: str, width: int) -> Any:
    """A function for ``numba.cfunc`` of addresses and sizes, from its text.

    Args:
        width: lanes that it computes.
    """
    definition: Any = ast.parse(source).body[0]
    names = [each.arg for each in definition.args.args]
    listed = ", ".join(names)

    def typing(context: Any, *given: Any) -> Any:  # noqa: ARG001
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ARG001
            _Writer(builder, width, dict(zip(names, values, strict=True))).run(definition.body)
            return context.get_dummy_value()

        return types.void(*[types.intp] * len(names)), code

    scope: dict[str, Any] = {"typing": typing, "__name__": __name__}
    exec(f"def body(context, {listed}): return typing(context, {listed})", scope)  # noqa: S102
    scope["body"] = intrinsic(scope["body"])
    call = f"def {definition.name}({listed}): body({listed})"
    exec(compile(call, __file__, "exec"), scope)  # noqa: S102
    return scope[definition.name]


class _Writer:
    """Writes statements; each name is a place on the stack, which LLVM turns into registers."""

    def __init__(self, builder: Any, width: int, arguments: dict[str, Any]) -> None:
        self.builder, self.functions = builder, written(width)
        self.places: dict[str, Any] = {}
        for name, value in arguments.items():
            self._assign(name, value)

    def run(self, statements: list[Any]) -> None:
        """Assignments, calls, branches where two integers are equal, and loops over a range."""
        for each in statements:
            if isinstance(each, ast.Assign):
                target: Any = each.targets[0]
                self._assign(target.id, self._value(each.value))
            elif isinstance(each, ast.Expr):
                self._value(each.value)
            elif isinstance(each, ast.If):
                test: Any = each.test
                pair = self._value(test.left), self._value(test.comparators[0])
                with self.builder.if_then(self.builder.icmp_signed("==", *pair)):
                    self.run(each.body)
            else:
                bounds = [self._value(bound) for bound in each.iter.args]
                start, stop, step = ([_WORD(0)] * (len(bounds) == 1) + bounds + [_WORD(1)])[:3]
                up = step.constant > 0
                loop = _cgutils.for_range_slice(self.builder, start, stop, step, _WORD, inc=up)
                with loop as (index, _):
                    self._assign(each.target.id, index)
                    self.run(each.body)

    def _assign(self, name: str, value: Any) -> None:
        if name not in self.places:
            self.places[name] = _cgutils.alloca_once(self.builder, value.type)
        self.builder.store(value, self.places[name])

    def _value(self, node: Any) -> Any:
        if isinstance(node, ast.Name):
            return self.builder.load(self.places[node.id])
        if isinstance(node, ast.UnaryOp):
            return self._value(ast.Constant(-node.operand.value))  # type: ignore[attr-defined]
        if isinstance(node, ast.Constant):
            return (_WORD if isinstance(node.value, int) else _DOUBLE)(node.value)
        if isinstance(node, ast.Call):
            function: Any = node.func
            return self.functions[function.id](self.builder, *map(self._value, node.args))
        operands = [self._value(node.left), self._value(node.right)]
        kinds = {each.type for each in operands}
        if kinds == {_WORD}:
            return getattr(self.builder, _INTEGERS[type(node.op)])(*operands)
        if _WORD in kinds:
            operands = [
                self.builder.sitofp(each, _DOUBLE) if each.type == _WORD else each
                for each in operands
            ]
        return getattr(self.builder, _DOUBLES[type(node.op)])(*operands)
