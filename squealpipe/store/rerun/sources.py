"""Source files that a script depends on, from the imports that they state, and their code."""

import ast
import hashlib
import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple

PACKAGE = Path(__file__).resolve().parents[2]
STATEMENT_CHECKS = PACKAGE / "paper/claims/checks"
"""Docstrings here are results: the table of statements shows them."""
DECLARED_BY = "INPUT_FILES"
"""Constant in which a module names what it reads beside what it imports."""
WORKFLOW = (PACKAGE / "workflow").resolve()
"""Rules, scripts and configurations: in a checkout a folder of its own, in a wheel within."""


class Source(NamedTuple):
    """Package modules that a file imports and reads, and the digest of its code.

    Attributes:
        laws: names of laws that it passes on; a name that is only compared does not count.
    """

    imports: frozenset[Path]
    code: str
    laws: frozenset[str] = frozenset()


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
    return sorted(modules, key=str)  # texts compare faster than Paths


@cache
def read_source(path: Path) -> Source:
    """Imports of a file, and the digest of its syntax tree without comments and docstrings.

    Docstrings of :data:`STATEMENT_CHECKS` count. A data file is taken as it is.
    """
    content = path.read_bytes()
    if path.suffix != ".py":
        return Source(frozenset(), hashlib.sha256(content).hexdigest()[:16])
    module = _parsed(content, path.parent == STATEMENT_CHECKS)
    files = {file for name in module.imports for file in _files(name)}
    if path.is_relative_to(PACKAGE):
        files |= {file for each in module.inputs for file in path.parent.glob(each)}
    return Source(frozenset(files), module.code, frozenset(module.laws))


@cache
def law_files() -> dict[Path, str]:
    """Return the modules of single laws, each with the law's name."""
    # where one law is imported, all are: they are found by name
    return {
        path: path.stem
        for folder in ("friction_laws", "contact_laws")
        for path in sorted(PACKAGE.glob(f"laws/{folder}/*.py"))
        if path.stem != "__init__"
    }


class _Module(NamedTuple):
    """Facts read from a module: its imports, ``INPUT_FILES``, digest, and the laws it names."""

    imports: list[str]
    inputs: list[str]
    code: str
    laws: list[str]


def _parsed(content: bytes, documented: bool) -> _Module:
    """Parse a module, or recall what the same text gave before.

    Parsing all modules takes as long as the rest of a dry run.
    """
    key = hashlib.sha256(content + bytes(documented)).hexdigest()[:32]
    known = _remembered()
    if key not in known:
        known[key] = _parse(content, documented)
        # where nothing can be written, it is parsed again next time
        with suppress(OSError), _memory().open("a", encoding="utf-8") as file:
            file.write(json.dumps([key, known[key]]) + "\n")
    return known[key]


@cache
def _memory() -> Path:
    """File in the user's cache folder, of this reader of sources and this Python alone."""
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
    names = ",".join(sorted(law_files().values()))  # looked for in every module
    reader = hashlib.sha256(
        Path(__file__).read_bytes() + sys.version.encode() + names.encode()
    )
    path = Path(user, "squealpipe", f"sources-{reader.hexdigest()[:16]}.jsonl")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
    return path


@cache
def _remembered() -> dict[str, _Module]:
    """Return what was found in texts that were parsed before, by their digest."""
    known = {}
    with suppress(OSError):
        for line in _memory().read_text(encoding="utf-8").splitlines():
            with suppress(ValueError, TypeError):  # torn by another process
                key, source = json.loads(line)
                known[key] = _Module(*source)
    return known


def _parse(content: bytes, documented: bool) -> _Module:
    tree = ast.parse(content)
    known = set(law_files().values())
    nodes = [tree, *_statements(tree.body)]
    names: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    inputs = [pattern for node in tree.body for pattern in _input_files(node)]
    for node in nodes if not documented else []:
        if isinstance(
            node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
        ):
            first = node.body[0] if node.body else None
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                node.body.pop(0)
    laws = set()
    # walking takes as long as parsing, and most modules name no law
    named = any(name.encode() in content for name in known)
    waiting: list[ast.AST] = [tree] if named else []
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Constant) and node.value in known:
            laws.add(node.value)
        elif not isinstance(node, ast.Compare):
            waiting.extend(ast.iter_child_nodes(node))
    own = sorted(name for name in names if name.partition(".")[0] == PACKAGE.name)
    code = hashlib.sha256(ast.dump(tree).encode()).hexdigest()[:16]
    return _Module(own, inputs, code, sorted(laws))


def _input_files(node: ast.stmt) -> Sequence[str]:
    """The patterns of ``INPUT_FILES``, if a statement assigns them."""
    assigned = isinstance(node, ast.Assign) and any(
        isinstance(target, ast.Name) and target.id == DECLARED_BY
        for target in node.targets
    )
    return ast.literal_eval(node.value) if assigned else ()  # type: ignore[attr-defined, no-any-return]


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
    files = []
    for depth in range(1, len(parts) + 1):
        base = PACKAGE.joinpath(*parts[1:depth])
        candidate = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
        if candidate.is_file():
            files.append(candidate)
    return files
