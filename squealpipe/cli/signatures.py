"""Options of a command take their defaults from the task that it calls.

The task's signature is read from its source, not imported: ``--help`` stays quick.
"""

import ast
import inspect
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import squealpipe

Command = TypeVar("Command", bound=Callable[..., int])


@cache
def defaults_of(task: str) -> dict[str, Any]:
    """Argument → default of a public function of the package; those that are literals."""
    place = squealpipe.HOME[task].split(".")[1:]
    path = Path(str(squealpipe.__file__)).parent.joinpath(*place).with_suffix(".py")
    for node in ast.parse(path.read_bytes()).body:
        if isinstance(node, ast.FunctionDef) and node.name == task:
            pairs = zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
            return {
                argument.arg: ast.literal_eval(default)
                for argument, default in pairs
                if default is not None and _is_literal(default)
            }
    raise LookupError(f"{path} defines no {task}")


def _is_literal(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True


def options_of(task: str) -> Callable[[Command], Command]:
    """Give the options of a command without a default that of the task's argument.

    Args:
        task: name in ``squealpipe`` of the function that the command calls.
    """

    def filled(command: Command) -> Command:
        known = defaults_of(task)
        options: Any = command
        options.__kwdefaults__ = {
            name: known[name]
            for name, option in inspect.signature(command).parameters.items()
            if option.kind is option.KEYWORD_ONLY
            and option.default is option.empty
            and name in known
        } | (options.__kwdefaults__ or {})
        options.task = task
        return command

    return filled
