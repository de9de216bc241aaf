"""Conditions on parameters, as text: ``mu == 0.25 and L1 > 4``. Parsed, never run as code."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from typing import Any

from squealpipe.parameters import SYMBOLS
from squealpipe.text import nearest

LONGEST = 1000
COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
}
ARITHMETIC: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


class Condition:
    """A condition on a run's configuration.

    Names are parameters (``mu``, ``length1``), the paper's symbols (``L1``), or keys of the
    configuration with their section (``linear.points``). There are comparisons (also chained, and
    ``in`` a list), ``and``, ``or``, ``not``, and + − * / of numbers; nothing else.

    Args:
        text: the condition.
        known: key → default, of all keys that a configuration can have. A run that does not tell
            a key (it was made before there was one) has its default.

    Raises:
        ValueError: it is no such condition, or names an unknown key.
    """

    def __init__(self, text: str, known: Mapping[str, Any]) -> None:
        self.text, self.known = text, known
        if len(text) > LONGEST:
            raise ValueError(f"the condition has {len(text)} characters; {LONGEST} are allowed")
        try:
            self.tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
            raise self._fault("it cannot be read") from error
        self.holds(known)

    def holds(self, config: Mapping[str, Any]) -> bool:
        """Whether a configuration (dotted key → value) fulfils it.

        Raises:
            ValueError: the values cannot be compared like this.
        """
        try:
            answer = self._value(self.tree, {**self.known, **config})
        except (TypeError, ZeroDivisionError, OverflowError, RecursionError) as error:
            raise self._fault(str(error)) from error
        if not isinstance(answer, bool):
            raise self._fault("it is no condition that is true or false")
        return answer

    def _value(self, node: ast.expr, config: Mapping[str, Any]) -> Any:
        match node:
            case ast.Constant(value=int() | float() | str() as value):
                return value
            case ast.Name() | ast.Attribute():
                return self._named(node, config)
            case ast.List(elts=items) | ast.Tuple(elts=items):
                return [self._value(item, config) for item in items]
            case ast.BoolOp(op=ast.And(), values=parts):
                return all(self._truth(part, config) for part in parts)
            case ast.BoolOp(op=ast.Or(), values=parts):
                return any(self._truth(part, config) for part in parts)
            case ast.UnaryOp(op=ast.Not(), operand=part):
                return not self._truth(part, config)
            case ast.UnaryOp(op=ast.USub(), operand=part):
                return -self._number(part, config)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC:
                return ARITHMETIC[type(op)](self._number(left, config), self._number(right, config))
            case ast.Compare(left=left, ops=ops, comparators=rest) if {
                type(op) for op in ops
            } <= set(COMPARISONS):
                values = [self._value(part, config) for part in (left, *rest)]
                return all(
                    COMPARISONS[type(op)](a, b)
                    for op, a, b in zip(ops, values[:-1], values[1:], strict=True)
                )
        raise self._fault(f"{ast.unparse(node)!r} is not allowed in it")

    def _truth(self, node: ast.expr, config: Mapping[str, Any]) -> bool:
        value = self._value(node, config)
        if not isinstance(value, bool):
            raise self._fault(f"{ast.unparse(node)!r} is no condition that is true or false")
        return value

    def _number(self, node: ast.expr, config: Mapping[str, Any]) -> float:
        value = self._value(node, config)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._fault(f"{ast.unparse(node)!r} is no number")
        return float(value)

    def _named(self, node: ast.expr, config: Mapping[str, Any]) -> Any:
        name = ast.unparse(node)
        for key in (f"parameters.{SYMBOLS.get(name, name)}", name):
            if key in config:
                return config[key]
        names = [key.removeprefix("parameters.") for key in self.known]
        near = nearest(name, [*names, *SYMBOLS])
        raise self._fault(
            f"{name!r} is not known; "
            + (f"did you mean {near!r}?" if near else "write for instance mu, L1, linear.points")
        )

    def _fault(self, reason: str) -> ValueError:
        return ValueError(f"{self.text!r}: {reason}; write for instance 'mu == 0.25 and L1 > 4'")
