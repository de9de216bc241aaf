"""Figures of reports: what each reads, shows and says, in one record that it registers.

A figure is one module ``figures/<topic>/<name>.py`` whose function ``draw`` is decorated with
:func:`report_figure`. The workflow asks often which datasets a figure reads, and must not wait for
Matplotlib and SciPy each time; so :func:`reads` takes them from the module's source.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PACKAGE_FOLDER = Path(__file__).resolve().parents[2]

Item = TypeVar("Item")
Draw = TypeVar("Draw", bound=Callable[..., "Figure"])


@dataclass(frozen=True)
class ReportFigure:
    """A figure of a report.

    Attributes:
        reads: names of its datasets (``"whirl"``, ``"simulate/F3"``). A name with a wildcard
            (``"backbone/F10_*"``) stands for all datasets that match, as a mapping by name.
        caption: what to see in it: a text, or a function of the same datasets.
        alt: what it looks like, for those who cannot see it: a text, or such a function.
        draw: takes the datasets in the order of ``reads``, returns a Matplotlib figure.
    """

    reads: tuple[str, ...]
    caption: str | Callable[..., str]
    alt: str | Callable[..., str]
    draw: Callable[..., Figure]


_registered: dict[str, ReportFigure] = {}


def report_figure(
    *,
    reads: tuple[str, ...],
    caption: str | Callable[..., str],
    alt: str | Callable[..., str],
) -> Callable[[Draw], Draw]:
    """Register the decorated function as the figure that its module is named after.

    Args:
        reads, caption, alt: as in :class:`ReportFigure`; ``reads`` written out as a tuple of
            texts, since it is read from the source, too.
    """

    def register(draw: Draw) -> Draw:
        name = draw.__module__.rpartition(".")[2]
        _registered[name] = ReportFigure(reads, caption, alt, draw)
        return draw

    return register


@cache
def find_module(name: str) -> Path:
    """Return the path of a figure's module.

    Raises:
        ValueError: if no module, or more than one, has this name.
    """
    files = list(PACKAGE_FOLDER.glob(f"*/figures/*/{name}.py"))
    if len(files) != 1:
        raise ValueError(
            f"{len(files)} modules figures/<topic>/{name}.py; one is needed"
        )
    return files[0]


@cache
def reads(name: str) -> tuple[str, ...]:
    """Return the names of the datasets that a figure reads, without importing its module.

    Raises:
        ValueError: if no function of the module is decorated with ``report_figure``, or its
            ``reads`` is not written out.
    """
    path = find_module(name)
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "report_figure":
            for keyword in node.keywords:
                if keyword.arg == "reads":
                    return _tuple_of_texts(path, keyword.value)
    raise ValueError(
        f"{path} declares no figure; decorate its function draw with "
        "@report_figure(reads=…, caption=…, alt=…)"
    )


def _tuple_of_texts(path: Path, expression: ast.expr) -> tuple[str, ...]:
    try:
        value = ast.literal_eval(expression)
    except ValueError:
        value = None
    if isinstance(value, tuple) and all(isinstance(name, str) for name in value):
        return value
    raise ValueError(
        f"{path}: reads = {ast.unparse(expression)}; write the names of the datasets out, as a "
        "tuple of texts"
    )


def datasets_of(name: str, known: Iterable[str]) -> list[str] | None:
    """Return the known datasets that a figure reads, or None where one that it needs is missing."""
    names = list(known)
    matches = [_matches(pattern, names) for pattern in reads(name)]
    return [match for matched in matches for match in matched] if all(matches) else None


def arguments(name: str, datasets: Mapping[str, Item]) -> list[Item | dict[str, Item]]:
    """Return the datasets of a figure in the order in which its function takes them.

    Raises:
        ValueError: if a dataset that it reads is missing.
    """
    ordered: list[Item | dict[str, Item]] = []
    for pattern in reads(name):
        matched = {match: datasets[match] for match in _matches(pattern, datasets)}
        if not matched:
            raise ValueError(
                f"the figure {name} reads the dataset {pattern}, which is missing"
            )
        has_wildcard = any(character in pattern for character in "*?[")
        ordered.append(matched if has_wildcard else matched[pattern])
    return ordered


def draw(name: str, datasets: Mapping[str, Any]) -> Figure:
    """Draw a figure from datasets by name."""
    return registered(name).draw(*arguments(name, datasets))


def texts(name: str, datasets: Mapping[str, Any]) -> tuple[str, str]:
    """Return the caption and the alternative text of a figure.

    Raises:
        ValueError: if one of them is empty.
    """
    figure = registered(name)
    return (
        _text(name, "caption", figure.caption, datasets),
        _text(name, "alt", figure.alt, datasets),
    )


def _text(
    name: str, field: str, text: str | Callable[..., str], datasets: Mapping[str, Any]
) -> str:
    written = text(*arguments(name, datasets)) if callable(text) else text
    if not written.strip():
        raise ValueError(
            f"the {field} of the figure {name} is empty; give a text or a function of its datasets"
        )
    return written.strip()


def topic(name: str) -> str:
    """Return the folder of a figure's module: figures of one topic are drawn by one rule."""
    return find_module(name).parent.name


def registered(name: str) -> ReportFigure:
    """Return the record of a figure; its module is imported if it is not yet.

    Raises:
        ValueError: if the module registers no figure.
    """
    path = find_module(name).relative_to(PACKAGE_FOLDER.parent).with_suffix("")
    module = import_module(".".join(path.parts))
    if name not in _registered:
        raise ValueError(
            f"{module.__name__} registers no figure; decorate its function draw with "
            "@report_figure(reads=…, caption=…, alt=…)"
        )
    return _registered[name]


def _matches(pattern: str, known: Iterable[str]) -> list[str]:
    return [name for name in known if name == pattern or fnmatchcase(name, pattern)]
