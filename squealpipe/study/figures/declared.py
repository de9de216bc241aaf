"""What figures declare: a figure is one module ``figures/<topic>/<name>.py``.

It holds ``READS``, the names of its datasets; ``draw``, which takes them in that order; and
``CAPTION`` and ``ALT``, each a text or a function of the same datasets. A name in ``READS`` with
a wildcard (``backbone/F10_*``) stands for all datasets that match, as a mapping by name.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = Path(__file__).resolve().parent
WILDCARDS = frozenset("*?[")

Item = TypeVar("Item")


def find_module(name: str) -> Path:
    """The module of a figure."""
    files = list(FOLDER.glob(f"*/{name}.py"))
    if len(files) != 1:
        raise ValueError(
            f"{len(files)} modules figures/<topic>/{name}.py; one is needed"
        )
    return files[0]


@cache
def reads(name: str) -> tuple[str, ...]:
    """``READS`` of a figure's module, read without importing it: the workflow asks often."""
    path = find_module(name)
    for node in ast.parse(path.read_bytes()).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "READS":
            found = ast.literal_eval(node.value)
            if isinstance(found, tuple) and all(
                isinstance(entry, str) for entry in found
            ):
                return found
    raise ValueError(
        f"{path} has no READS; give the names of its datasets as a tuple of texts"
    )


def datasets_of(name: str, known: Iterable[str]) -> list[str] | None:
    """Names of the known datasets that a figure reads; None where one that it needs is missing."""
    names = list(known)
    matches = [_matches(entry, names) for entry in reads(name)]
    return [match for matched in matches for match in matched] if all(matches) else None


def arguments(name: str, datasets: Mapping[str, Item]) -> list[Item | dict[str, Item]]:
    """The datasets of a figure in the order in which it declares them."""
    ordered: list[Item | dict[str, Item]] = []
    for entry in reads(name):
        matched = {match: datasets[match] for match in _matches(entry, datasets)}
        if not matched:
            raise ValueError(
                f"the figure {name} reads the dataset {entry}, which is not there"
            )
        ordered.append(matched if WILDCARDS & set(entry) else matched[entry])
    return ordered


def draw(name: str, datasets: Mapping[str, Any]) -> Figure:
    """Draw a figure from the datasets that it declares."""
    figure: Figure = _import(name).draw(*arguments(name, datasets))
    return figure


def texts(name: str, datasets: Mapping[str, Any]) -> tuple[str, str]:
    """Caption and alternative text of a figure."""
    module, written = _import(name), []
    for constant in ("CAPTION", "ALT"):
        text = getattr(module, constant, "")
        text = text(*arguments(name, datasets)) if callable(text) else text
        if not isinstance(text, str) or not text.strip():
            raise ValueError(
                f"{module.__name__} has no {constant}; give a text or a function of its datasets"
            )
        written.append(text.strip())
    return written[0], written[1]


def topic(name: str) -> str:
    """Folder of a figure's module: figures of one topic are drawn by one rule."""
    return find_module(name).parent.name


def _matches(entry: str, known: Iterable[str]) -> list[str]:
    return [name for name in known if name == entry or fnmatchcase(name, entry)]


def _import(name: str) -> Any:
    return import_module(f"{__package__}.{topic(name)}.{name}")
