"""Which source files a script depends on, from the imports that they state.

Snakemake does not see the package behind a thin script. Each rule therefore lists, as inputs,
the package modules in the import closure of its script: exactly those whose edit can change
its result.
"""

from __future__ import annotations

import ast
import hashlib
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Source:
    """One file; the workflow asks for its imports, a job for the digest of its code."""

    content: bytes

    @cached_property
    def imports(self) -> frozenset[Path]:
        """Package files that it imports."""
        names: set[str] = set()
        for node in _statements(ast.parse(self.content).body):
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module)
                names.update(f"{node.module}.{alias.name}" for alias in node.names)
        return frozenset(path for name in names for path in _files(name))

    @cached_property
    def code(self) -> str:
        """Digest of its code."""
        return _code_digest(ast.parse(self.content))


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


def imported_modules(source: Path) -> frozenset[Path]:
    """Package files that one file imports by name."""
    return first_seen(source).imports


def code_digests(files: Iterable[str | Path]) -> dict[str, str]:
    """File → digest of its code without comments and docstrings, as this process first saw it."""
    return {name_of(path): first_seen(path).code for path in map(_absolute, files)}


def edited(files: Iterable[str | Path]) -> list[str]:
    """Names of the files whose code is no longer what this process first saw."""
    return [name_of(path) for path in map(_absolute, files) if _is_edited(path)]


@cache
def name_of(path: Path) -> str:
    """Path from the folder that holds the package; the bare name of a file elsewhere."""
    root = PACKAGE.parent
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


@cache
def first_seen(source: Path) -> Source:
    """A file as it is at the first call of this process."""
    return Source(source.read_bytes())


def _is_edited(path: Path) -> bool:
    before = first_seen(path)
    try:
        content = path.read_bytes()
        return content != before.content and _code_digest(ast.parse(content)) != before.code
    except (OSError, SyntaxError):  # deleted, or saved half-way through an edit
        return True


def _code_digest(tree: ast.Module) -> str:
    """Digest of a syntax tree, whose docstrings are removed."""
    for node in [tree, *_statements(tree.body)]:
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                node.body.pop(0)
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()[:8]


def _absolute(path: str | Path) -> Path:
    return _resolved(os.path.abspath(path))  # noqa: PTH100  thousands of times: twice as fast


@cache
def _resolved(path: str) -> Path:
    return Path(path).resolve()


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
