"""Which rule makes which file from which datasets, read off the workflow's rules.

Knows no workflow engine: a rule is anything with ``name``, ``input`` and ``output``.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def lineage(
    rules: Iterable[Any], data_folder: str, figure_folder: str
) -> dict[str, dict[str, dict[str, Any]]]:
    """Datasets and figures by name, each with its path, rule and the datasets it was made from.

    Args:
        rules: objects with ``name``, ``input`` and ``output`` (iterables of paths).
        data_folder, figure_folder: where datasets and figures are, each ending in ``/``.
    """
    found: dict[str, dict[str, dict[str, Any]]] = {"datasets": {}, "figures": {}}
    for rule in rules:
        read = sorted({_name(path, data_folder) for path in _paths(rule.input, data_folder, ".nc")})
        for kind, folder, suffix in (
            ("datasets", data_folder, ".nc"),
            ("figures", figure_folder, ".png"),
        ):
            for path in _paths(rule.output, folder, suffix):
                found[kind][_name(path, folder)] = {
                    "path": path,
                    "rule": rule.name,
                    "datasets": read,
                }
    return found


def _paths(items: Iterable[Any], folder: str, suffix: str) -> list[str]:
    return [
        str(item)
        for item in items
        if isinstance(item, str) and item.startswith(folder) and item.endswith(suffix)
    ]


def _name(path: str, folder: str) -> str:
    return path.removeprefix(folder).rsplit(".", 1)[0]
