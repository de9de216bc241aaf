"""Options of a command take their defaults from the task that it calls.

The task's signature is read from its source, not imported: ``--help`` stays quick.
"""

import ast
import inspect
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import squealpipe

Command = TypeVar("Command", bound=Callable[..., int])


@cache
def defaults_of(task: str) -> dict[str, Any]:
    """Argument → default of a public function of the package; those that are literals."""
    package = Path(str(squealpipe.__file__)).parent
    module = next(
        str(node.module)
        for node in ast.parse((package / "__init__.pyi").read_bytes()).body
        if isinstance(node, ast.ImportFrom)
        and task in {alias.name for alias in node.names}
    )
    path = package.joinpath(*module.split(".")).with_suffix(".py")
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


def in_options(text: str) -> str:
    """The words of a task in those of a terminal: ``--n-modes 32`` for ``n_modes=32``."""
    text = re.sub(r"\bmu=\{'(\w+)': …\}", r"--mu \1=…", text)
    text = re.sub(r"\bmu = (?=[\d.])", "--mu ", text)
    # arguments of structures that messages name are named as the options are
    for name in ("n_modes", "frequency_max", "t_end"):
        option = f"--{name.replace('_', '-')}"
        text = re.sub(rf"\b{name} ?= ?(?=[\w'.+-])", f"{option} ", text)
        text = re.sub(rf"(?<![\w-]){name}\b", option, text)
    return text


@contextmanager
def errors_in_options() -> Iterator[None]:
    """Have errors of a structure's task say what to type."""
    try:
        yield
    except ValueError as error:
        raise ValueError(in_options(str(error))) from error
