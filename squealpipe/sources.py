"""Which source files a script depends on, from the imports that they state.

Snakemake does not see the package behind a thin script. Each rule therefore lists, as inputs,
the package modules in the import closure of its script: exactly those whose edit can change
its result.
"""

from __future__ import annotations

import ast
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
    for node in _nodes(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    return frozenset(path for name in names for path in _files(name))


def _nodes(tree: ast.AST) -> list[ast.AST]:
    nodes = []
    for child in ast.iter_child_nodes(tree):
        if isinstance(child, ast.If) and getattr(child.test, "id", "") == "TYPE_CHECKING":
            continue
        nodes.append(child)
        nodes.extend(_nodes(child))
    return nodes


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
