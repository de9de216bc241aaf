"""Lineage of the datasets: which rule makes each from which others, read off the workflow's rules.

Knows no workflow engine: a rule is anything with ``name``, ``input`` and ``output``.
"""

from collections.abc import Iterable
from typing import Any


def lineage(rules: Iterable[Any], folder: str) -> dict[str, dict[str, Any]]:
    """Datasets by name, each with its path, rule and the datasets that it was made from."""
    ancestors: dict[str, dict[str, Any]] = {}
    for rule in rules:
        read = sorted(set(_names(rule.input, folder)))
        for name in _names(rule.output, folder):
            ancestors[name] = {
                "path": f"{folder}{name}.nc",
                "rule": rule.name,
                "datasets": read,
            }
    return ancestors


def _names(items: Iterable[Any], folder: str) -> list[str]:
    return [
        item.removeprefix(folder).removesuffix(".nc")
        for item in items
        if isinstance(item, str) and item.startswith(folder) and item.endswith(".nc")
    ]
