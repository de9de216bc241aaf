"""The key of a result: what it was made from, in one line.

A rule's key is the digest of its slice of the configuration, of the code of its script and of all
that this imports, and of the keys of what it reads. The workflow gives it to the rule as a
parameter, so Snakemake runs the rule again when it changes; the results state it, so the report
and archives can hold each file against what it should be.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from squealpipe.rerun.sources import PACKAGE, closure, read_source

PARTS = ("data", "figures", "report")
"""Folders of a run that hold results."""

WATCHERS = frozenset({"sources.py", "key.py", "progress.py"})
"""Modules that watch jobs: no result depends on them."""

STARTED = "SQUEALPIPE_STARTED"
"""Environment variable with the time at which the workflow read its sources, s since 1970."""

PLAN = "SQUEALPIPE_PLAN"
"""Environment variable with the file into which the workflow writes what its results should be."""

MARK = b"squealpipe key: "


def canonical(config: Any) -> str:
    """One text for one meaning: sorted keys, no white space."""
    return json.dumps(config, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest(text: str | bytes) -> str:
    """Sixteen hexadecimal digits of SHA-256."""
    return hashlib.sha256(text.encode() if isinstance(text, str) else text).hexdigest()[:16]


def sources(*scripts: Path) -> list[Path]:
    """Scripts and modules whose code decides their results, with all that they import."""
    found = dict.fromkeys([*scripts, *(path for each in scripts for path in closure(each))])
    return [path for path in found if path.name not in WATCHERS]


def rule_key(
    part: Mapping[str, Any], code: Iterable[Path], inputs: Mapping[str, str] | None = None
) -> str:
    """Digest of all that decides the results of a rule.

    Args:
        part: its slice of the configuration; files that it names enter with their content.
        code: what :func:`sources` gives.
        inputs: name → key or digest of what it reads.
    """
    root = PACKAGE.parent
    modules = {
        path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name: (
            read_source(path).code
        )
        for path in code
    }
    files = {name: digest(Path(name).read_bytes()) for name in _files_named_in(part)}
    # keys of a sweep in the order given, which is that of its dimensions
    return digest(
        json.dumps(part, allow_nan=False) + canonical([modules, dict(inputs or {}), files])
    )


def file_key(key: str, path: str | os.PathLike[str]) -> str:
    """The key that a file of a run states: that of its rule, and which of its results it is."""
    parts = Path(path).parts
    place = max((i for i, part in enumerate(parts[:-1]) if part in PARTS), default=len(parts) - 1)
    return f"{key} {'/'.join(parts[place:])}"


def state_key(path: str | Path, key: str) -> None:
    """Add the key to a finished figure, page or JSON file, as a comment behind its content."""
    target, line = Path(path), MARK + file_key(key, path).encode()
    if target.suffix == ".json":
        content = json.loads(target.read_text(encoding="utf-8"))
        target.write_text(json.dumps({**content, "made": line.decode()}, indent=1), "utf-8")
        return
    with target.open("ab") as file:
        markup = target.suffix in {".svg", ".html"}
        file.write(b"\n<!-- " + line + b" -->\n" if markup else b"\n% " + line + b"\n")


def key_behind(path: str | Path) -> str | None:
    """The key that :func:`state_key` added to a file; None if it states none."""
    found = re.search(MARK + rb"([0-9a-f]{16} [\w./-]+)", Path(path).read_bytes()[-400:])
    return found[1].decode() if found else None


def _files_named_in(value: Any) -> Iterator[str]:
    """Files that a slice names: a table of friction, or a system as FILE.py:NAME."""
    if isinstance(value, str):
        file = value.partition(":")[0]
        if "." in file and Path(file).is_file():
            yield file
    elif isinstance(value, Mapping | list | tuple):
        for item in value.values() if isinstance(value, Mapping) else value:
            yield from _files_named_in(item)
