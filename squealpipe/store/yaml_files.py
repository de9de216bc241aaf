"""YAML files as plain data: no code, no duplicate key."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from squealpipe.store.mistakes import ConfigError


class _Loader(yaml.SafeLoader):
    """Numbers and words of YAML 1.2: 1e-9 is a number; 1:3:20 and 2020-01-01 are text."""

    yaml_implicit_resolvers = {}  # noqa: RUF012 (as the parent class has it)

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()  # type: ignore[no-untyped-call]
            what = f"alias *{event.anchor}; write the value out"
            raise yaml.MarkedYAMLError(problem=what, problem_mark=event.start_mark)
        return super().compose_node(parent, index)

    def construct_mapping(
        self, node: yaml.MappingNode, deep: bool = False
    ) -> dict[Any, Any]:
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                what = "a key that is a list or has keys itself; write one word"
                raise yaml.MarkedYAMLError(problem=what, problem_mark=key.start_mark)
            if key.value in seen:
                what = f"key {key.value!r} is a duplicate; keep one"
                raise yaml.MarkedYAMLError(problem=what, problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep=deep)


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


def parsed(text: str) -> Any:
    """Return what a text in YAML says."""
    return yaml.load(text, _Loader)  # noqa: S506 (a safe one)


def read_yaml(path: Path) -> dict[str, Any]:
    """Content of a file."""
    if not path.is_file():
        raise FileNotFoundError(
            f"no configuration {path}; give a YAML file that exists"
        )
    try:
        content = parsed(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise ConfigError(
            [
                f"{path}: byte {error.start + 1} is not UTF-8; save the file in that encoding"
            ]
        ) from error
    except yaml.MarkedYAMLError as error:
        line = (
            ""
            if error.problem_mark is None
            else f", line {error.problem_mark.line + 1}"
        )
        hint = "; indent with spaces" if "\\t" in str(error.problem) else ""
        raise ConfigError(
            [f"{path}{line} is not plain YAML: {error.problem}{hint}"]
        ) from error
    except (yaml.YAMLError, ValueError) as error:
        raise ConfigError(
            [f"{path} is not plain YAML: {' '.join(str(error).split())}"]
        ) from error
    if not isinstance(content, dict | None):
        kind = type(content).__name__
        raise ConfigError([f"{path} must hold keys and values, not {kind}"])
    return content or {}


def overlay(base: dict[str, Any], top: Mapping[str, Any]) -> None:
    """Lay one configuration over another, key by key, in place; an empty section adds none."""
    for key, value in top.items():
        if isinstance(base.get(key), dict) and (
            value is None or isinstance(value, Mapping)
        ):
            overlay(base[key], value or {})
        else:
            base[key] = value


def flat(tree: Mapping[str, Any], stem: str = "") -> dict[str, Any]:
    """Dotted key → value, for all that is not a mapping."""
    leaves: dict[str, Any] = {}
    for key, value in tree.items():
        path = f"{stem}.{key}" if stem else str(key)
        leaves |= flat(value, path) if isinstance(value, Mapping) else {path: value}
    return leaves
