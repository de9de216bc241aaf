"""Which source files a script depends on, from the imports that they state.

Snakemake does not see the package behind a thin script. Each rule therefore lists, as inputs,
the package modules in the import closure of its script: exactly those whose edit can change
its result.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent


def closure(script: str | Path) -> list[Path]:
    """Package modules that ``script`` imports, directly or not, sorted.

    Imports below ``if TYPE_CHECKING`` do not count; imports inside functions do.
    """
    found: set[Path] = set()
    waiting = [Path(script)]
    while waiting:
        for module in imported_modules(waiting.pop()):
            if module not in found:
                found.add(module)
                waiting.append(module)
    return sorted(found)


@cache
def imported_modules(source: Path) -> frozenset[Path]:
    """Package files that one file imports by name."""
    names: set[str] = set()
    for node in _statements(ast.parse(source.read_bytes()).body):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    return frozenset(path for name in names for path in _files(name))


def _statements(body: Sequence[ast.AST]) -> Iterator[ast.AST]:
    """Statements at any depth; expressions, which hold no imports, are not entered."""
    for node in body:
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            yield from _statements(node.orelse)
            continue
        yield node
        for part in ("body", "orelse", "finalbody", "handlers", "cases"):
            inner = getattr(node, part, None)
            if isinstance(inner, list):
                yield from _statements(inner)


@cache
def _files(name: str) -> list[Path]:
    """The module's file and the ``__init__`` of each package above it."""
    parts = name.split(".")
    if parts[0] != PACKAGE.name:
        return []
    files = []
    for depth in range(1, len(parts) + 1):
        base = PACKAGE.joinpath(*parts[1:depth])
        candidate = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        if candidate.is_file():
            files.append(candidate)
    return files
