"""Compiled functions from source text, written as LLVM's code at once.

The text is Python over addresses, numbers and rows of them: assignments, calls, branches, loops.
numba would compile it too, but takes ten times as long to find the types of its hundreds of lines.
"""

import ast
from functools import cache
from pathlib import Path
from typing import Any, cast

from llvmlite import ir
from numba.core import cgutils

from squealpipe.systems.taylor import simd
from squealpipe.systems.taylor.machine import address_of

_cgutils: Any = cgutils
_word_type, _double_type = ir.IntType(64), ir.DoubleType()


def compile_source(source: str, width: int = simd.LANES) -> int:
    """The address of a function of addresses and sizes from its text, stored under a digest of it.

    Args:
        width: lanes of the rows that it computes.
    """
    # to read all of the text takes several times as long as to load what is stored
    names = source[source.index("(") + 1 : source.index(")")].split(", ")

    def write(builder: Any, values: Any) -> None:
        arguments = dict(zip(names, values, strict=True))
        body = cast("Any", ast.parse(source).body[0]).body
        _Writer(builder, width, arguments, body).finish(body)

    content = f"{source}{width}".encode()
    return address_of(write, len(names), _own_sources() + content)


@cache
def _own_sources() -> bytes:
    """Sources that decide how text becomes LLVM's code."""
    return b"".join(Path(path or "").read_bytes() for path in (simd.__file__, __file__))


def _assigned_once(statements: list[Any]) -> set[str]:
    """Names that have one value wherever they are read."""
    blocks: dict[str, list[tuple[int, ...]]] = {}
    read: dict[str, list[tuple[int, ...]]] = {}

    def visit(inner: list[Any], block: tuple[int, ...]) -> None:
        for place, each in enumerate(inner):
            if isinstance(each, (ast.If, ast.For)):
                head = each.test if isinstance(each, ast.If) else each.iter
                note(head, block)
                if isinstance(each, ast.For):
                    note(each.target, (*block, place))
                visit(each.body, (*block, place))
            else:
                note(each, block)

    def note(statement: Any, block: tuple[int, ...]) -> None:
        for node in ast.walk(statement):
            if isinstance(node, ast.Name):
                table = blocks if isinstance(node.ctx, ast.Store) else read
                table.setdefault(node.id, []).append(block)

    visit(statements, ())
    return {
        name
        for name, (first, *others) in blocks.items()
        if not others
        and all(block[: len(first)] == first for block in read.get(name, ()))
    }


class _Writer:
    """Writes statements.

    A name with one value is that value; others are places on the stack, which LLVM turns into
    registers, but in half of the time that it takes for all.
    """

    def __init__(
        self, builder: Any, width: int, arguments: dict[str, Any], statements: list[Any]
    ) -> None:
        self.builder, self.functions = builder, simd.written(width)
        self.end = builder.append_basic_block("end")
        self.places: dict[str, Any] = {}
        self.once = _assigned_once(statements)
        self.values = dict(arguments)

    def finish(self, statements: list[Any]) -> None:
        """The whole body."""
        self._run(statements)
        if not self.builder.block.is_terminated:
            self.builder.branch(self.end)
        self.builder.position_at_end(self.end)

    def _run(self, statements: list[Any]) -> None:
        for each in statements:
            if isinstance(each, ast.Assign):
                target: Any = each.targets[0]
                self._assign(target.id, self._value(each.value))
            elif isinstance(each, ast.Expr):
                self._value(each.value)
            elif isinstance(each, ast.Return):
                self.builder.branch(self.end)
            elif isinstance(each, ast.If):
                with self.builder.if_then(self._test(each.test)):
                    self._run(each.body)
            else:
                bounds = [self._value(bound) for bound in each.iter.args]
                start, stop, step = (
                    [_word_type(0)] * (len(bounds) == 1) + bounds + [_word_type(1)]
                )[:3]
                up = step.constant > 0
                loop = _cgutils.for_range_slice(
                    self.builder, start, stop, step, _word_type, inc=up
                )
                with loop as (index, _):
                    self._assign(each.target.id, index)
                    self._run(each.body)

    def _assign(self, name: str, value: Any) -> None:
        if name in self.once:
            self.values[name] = value
            return
        if name not in self.places:
            self.places[name] = _cgutils.alloca_once(self.builder, value.type)
        self.builder.store(value, self.places[name])

    def _test(self, node: Any) -> Any:
        pair = self._value(node.left), self._value(node.comparators[0])
        tests = {ast.Eq: "==", ast.NotEq: "!=", ast.GtE: ">="}
        symbol = tests[type(node.ops[0])]
        if pair[0].type == _word_type:
            return self.builder.icmp_signed(symbol, *pair)
        unlike = self.builder.fcmp_unordered  # NaN is unlike anything
        return (unlike if symbol == "!=" else self.builder.fcmp_ordered)(symbol, *pair)

    def _value(self, node: Any) -> Any:
        if isinstance(node, ast.Name):
            if node.id in self.values:
                return self.values[node.id]
            return self.builder.load(self.places[node.id])
        if isinstance(node, ast.Constant):
            return (_word_type if isinstance(node.value, int) else _double_type)(
                node.value
            )
        if isinstance(node, ast.UnaryOp):
            operand: Any = node.operand
            if isinstance(operand, ast.Constant):
                return self._value(ast.Constant(-operand.value))  # type: ignore[operator]
            return self.builder.fneg(self._value(operand))
        if isinstance(node, ast.Call):
            function: Any = node.func
            name = (
                getattr(function, "id", None) or function.attr
            )  # also of the module math
            return self.functions[name](self.builder, *map(self._value, node.args))
        operands = [self._value(node.left), self._value(node.right)]
        kinds = {each.type for each in operands}
        if kinds == {_word_type}:
            # integers that are not negative: their quotient is rounded down
            instructions: dict[Any, str] = {
                ast.Add: "add",
                ast.Sub: "sub",
                ast.Mult: "mul",
                ast.FloorDiv: "sdiv",
                ast.Mod: "srem",
            }
            return getattr(self.builder, instructions[type(node.op)])(*operands)
        if _word_type in kinds:
            operands = [
                self.builder.sitofp(each, _double_type)
                if each.type == _word_type
                else each
                for each in operands
            ]
        if isinstance(node.op, ast.Pow):
            return self.functions["pow"](self.builder, *operands)
        doubles = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
        return getattr(self.builder, doubles[type(node.op)])(*operands)
