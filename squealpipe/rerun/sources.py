"""Which source files a script depends on, from the imports that they state, and their code."""

import ast
import hashlib
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

PACKAGE = Path(__file__).resolve().parents[1]
STATEMENTS = PACKAGE / "study/claims/checks"
"""Docstrings here are results: the table of statements shows them."""
INPUT_FILES = "INPUT_FILES"
"""Constant in which a module names what it reads beside what it imports."""
WORKFLOW = (PACKAGE / "workflow").resolve()
"""Rules, scripts and configurations: in a checkout a folder of its own, in a wheel within."""


class Source(NamedTuple):
    """What one file imports and reads from the package, and the digest of its code."""

    imports: frozenset[Path]
    code: str


def closure(script: str | Path) -> list[Path]:
    """Package modules that ``script`` imports, directly or not, and files that they read, sorted.

    What no import statement shows, modules state beside it: ``INPUT_FILES`` has the patterns of
    data files that a module reads and of modules that it imports by name. Imports below
    ``if TYPE_CHECKING`` do not count; imports inside functions do.
    """
    modules: set[Path] = set()
    waiting = [Path(script)]
    while waiting:
        for module in read_source(waiting.pop()).imports:
            if module not in modules:
                modules.add(module)
                waiting.append(module)
    return sorted(modules)


@cache
def read_source(path: Path) -> Source:
    """Imports of a file, and the digest of its syntax tree without comments and docstrings.

    Docstrings of :data:`STATEMENTS` count. A data file is taken as it is.
    """
    if path.suffix != ".py":
        return Source(frozenset(), hashlib.sha256(path.read_bytes()).hexdigest()[:16])
    tree = ast.parse(path.read_bytes())
    nodes = [tree, *_statements(tree.body)]
    names: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    for node in nodes if path.parent != STATEMENTS else []:
        if isinstance(
            node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        ):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                node.body.pop(0)
    code = hashlib.sha256(ast.dump(tree).encode()).hexdigest()[:16]
    imported = {file for name in names for file in _files(name)}
    return Source(frozenset(imported | _input_files(path, tree)), code)


def _input_files(path: Path, tree: ast.Module) -> set[Path]:
    """Files beside a module of the package that its ``INPUT_FILES`` names."""
    if not path.is_relative_to(PACKAGE):
        return set()
    for node in tree.body:
        if isinstance(node, ast.Assign) and any(
            isinstance(target, ast.Name) and target.id == INPUT_FILES
            for target in node.targets
        ):
            patterns = ast.literal_eval(node.value)
            return {file for each in patterns for file in path.parent.glob(each)}
    return set()


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
