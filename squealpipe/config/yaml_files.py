"""YAML files as plain data, with the line of every key: no code, no alias, no duplicate key."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

Lines = dict[tuple[str, ...], int]


class _Loader(yaml.SafeLoader):
    """Numbers and words of YAML 1.2: 1e-9 is a number; 1:3:20 and 2020-01-01 are text."""

    yaml_implicit_resolvers = {}  # noqa: RUF012 (as the parent class has it)


for _kind, _form, _first in (
    ("null", r"~|null|Null|NULL|", "~nN"),
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("int", r"[-+]?(0|[1-9]\d*)", "-+0123456789"),
    (
        "float",
        r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        "-+.0123456789",
    ),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_kind}", re.compile(f"^({_form})$"), [*_first, ""]
    )


def read_yaml(path: Path) -> tuple[dict[str, Any], Lines, list[str]]:
    """Content of a file, key with those above it → line, and faults; list items by their place.

    Raises:
        FileNotFoundError: no such file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no configuration {path}; give a YAML file that exists")
    lines: Lines = {}
    try:
        loader = _Loader(path.read_text(encoding="utf-8"))
        root = loader.get_single_node()
        if root is None:
            return {}, lines, []
        faults = [f"{path}, line {line}: {what}" for line, what in _walk(root, (), lines, set())]
        content = loader.construct_document(root)
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        hint = "; indent with spaces" if "\\t" in str(error.problem) else ""
        return {}, lines, [f"{path}{line} is not plain YAML: {error.problem}{hint}"]
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        return {}, lines, [f"{path} is not plain YAML: {' '.join(str(error).split())}"]
    if not isinstance(content, dict):
        return {}, lines, [f"{path} must hold keys and values, not {type(content).__name__}"]
    return content, lines, faults


def _walk(
    node: yaml.Node, above: tuple[str, ...], lines: Lines, seen: set[int]
) -> Iterator[tuple[int, str]]:
    """Note the line of each key, and give line and fault of what a configuration cannot hold."""
    if id(node) in seen:  # aliases of aliases would grow without bound
        problem = "an alias refers to this; write the value out there too"
        raise yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)
    seen.add(id(node))
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            here, line = (*above, str(key.value)), key.start_mark.line + 1
            if here in lines:
                yield line, f"key {key.value!r} is a duplicate; keep one"
            lines[here] = line
            yield from _walk(value, here, lines, seen)
    elif isinstance(node, yaml.SequenceNode):
        for place, item in enumerate(node.value):
            here = (*above, str(place))
            lines[here] = item.start_mark.line + 1
            yield from _walk(item, here, lines, seen)


def overlay(base: dict[str, Any], top: Mapping[str, Any]) -> None:
    """Lay one configuration over another, key by key, in place; an empty section adds none."""
    for key, value in top.items():
        if isinstance(base.get(key), dict) and (value is None or isinstance(value, Mapping)):
            overlay(base[key], value or {})
        else:
            base[key] = value


def flat(tree: Mapping[str, Any], stem: str = "") -> dict[str, Any]:
    """Dotted key → value, for all that is not a mapping."""
    found: dict[str, Any] = {}
    for key, value in tree.items():
        path = f"{stem}.{key}" if stem else str(key)
        if isinstance(value, Mapping):
            found.update(flat(value, path))
        else:
            found[path] = value
    return found
