"""YAML files as plain data: bounded, without code, aliases or a key written twice."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

LARGEST = 2**20
DEEPEST = 20
CODE = "__use_yte__"
"""The key by which a file would ask Snakemake to evaluate its text as Python."""

BASE_60 = re.compile(r"[-+]?\d[\d_]*(?::[0-5]?\d)+(?:\.[\d_]*)?")
"""Text like 1:3:20, which YAML 1.1 takes for a single number to base 60."""

PLAIN_TAGS = frozenset(f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool"))


def read_yaml(path: Path) -> tuple[dict[str, Any], list[str]]:
    """Content of a file and its faults; with faults the content may be incomplete.

    Raises:
        FileNotFoundError: no such file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no configuration {path}; give a YAML file that exists")
    size = path.stat().st_size
    if size > LARGEST:
        return {}, [f"{path} has {size} bytes; a configuration has at most {LARGEST}"]
    try:
        text = path.read_text(encoding="utf-8")
        faults = [f"{path}, line {line}: {what}" for line, what in _faults(text)]
        fatal = any("deep" in fault or "alias" in fault or "tag" in fault for fault in faults)
        content = {} if fatal else yaml.safe_load(text)
    except UnicodeDecodeError as error:
        return {}, [f"{path} is not UTF-8 text: {error}"]
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        return {}, [f"{path}{line} is not YAML: {error.problem}{_hint(error)}"]
    except (yaml.YAMLError, ValueError) as error:
        return {}, [f"{path} is not YAML: {' '.join(str(error).split())}"]
    if content is None:
        return {}, faults
    if not isinstance(content, dict):
        return {}, [*faults, f"{path} must hold keys and values, not {type(content).__name__}"]
    content.pop(CODE, None)
    return content, faults


def _hint(error: yaml.MarkedYAMLError) -> str:
    if "\\t" in str(error.problem):
        return "; indent with spaces"
    begun = error.context_mark
    return "" if begun is None else f" ({error.context}, from line {begun.line + 1} on)"


def overlay(base: dict[str, Any], top: Mapping[str, Any]) -> None:
    """Lay one configuration over another, key by key, in place; an empty section adds none."""
    for key, value in top.items():
        if isinstance(base.get(key), dict) and (value is None or isinstance(value, Mapping)):
            overlay(base[key], value or {})
        else:
            base[key] = value


def key_lines(path: Path) -> dict[tuple[str, ...], int]:
    """Key, with those above it, → line of a file in which it stands; list items by their place."""
    found: dict[tuple[str, ...], int] = {}

    def walk(node: yaml.Node, above: tuple[str, ...]) -> None:
        if isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                here = (*above, str(key.value))
                found[here] = key.start_mark.line + 1
                walk(value, here)
        elif isinstance(node, yaml.SequenceNode):
            for place, item in enumerate(node.value):
                here = (*above, str(place))
                found[here] = item.start_mark.line + 1
                walk(item, here)

    root = yaml.compose(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
    if root is not None:
        walk(root, ())
    return found


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


def _faults(text: str) -> Iterator[tuple[int, str]]:
    """Line and fault, from the events of the text, before anything is built from it."""
    stack: list[set[str] | None] = []
    at_key: list[bool] = []
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        line = event.start_mark.line + 1 if event.start_mark else 0
        if isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            stack.pop()
            at_key.pop()
            continue
        if not isinstance(event, yaml.NodeEvent):
            continue
        yield from ((line, what) for what in _node_faults(event))
        if isinstance(event, yaml.ScalarEvent) and stack and stack[-1] is not None and at_key[-1]:
            yield from ((line, what) for what in _key_faults(event.value, stack[-1]))
            stack[-1].add(event.value)
        if stack:
            at_key[-1] = not at_key[-1]
        if isinstance(event, yaml.CollectionStartEvent):
            stack.append(set() if isinstance(event, yaml.MappingStartEvent) else None)
            at_key.append(True)
            if len(stack) > DEEPEST:
                yield line, f"more than {DEEPEST} levels deep"
                return


def _node_faults(event: yaml.NodeEvent) -> Iterator[str]:
    tag = getattr(event, "tag", None)
    if isinstance(event, yaml.AliasEvent):
        yield f"alias *{event.anchor}: write the value out"
    elif tag not in {None, "!", *PLAIN_TAGS}:
        yield f"tag {tag}: a configuration holds plain values only"
    elif (
        isinstance(event, yaml.ScalarEvent) and event.implicit[0] and BASE_60.fullmatch(event.value)
    ):
        yield f"{event.value} is one number to YAML; write '{event.value}' in quotes"


def _key_faults(key: str, seen: set[str]) -> Iterator[str]:
    if key in seen:
        yield f"key {key!r} is a duplicate; keep one"
    if key == CODE:
        yield f"key {CODE!r} would run code; a configuration is data"
