"""The key of a result: what it was made from, in one line.

A rule's key is the digest of its slice of the configuration, of the code of its script and of all
that this imports, and of the keys of what it reads. The workflow gives it to the rule as a
parameter, so Snakemake runs the rule again when it changes; the results state it, so the report
and archives can hold each file against what it should be.
"""

import gzip
import hashlib
import json
import os
import re
import sys
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from squealpipe.store.rerun.sources import (
    DECLARED_BY,
    PACKAGE,
    closure,
    law_files,
    read_source,
)

PARTS = ("data", "figures", "report")
"""Folders of a run that hold results."""

WATCHERS = frozenset({"sources.py", "key.py", "progress.py", "durations.py"})
"""Modules that watch jobs: no result depends on them."""

STARTED = "SQUEALPIPE_STARTED"
"""Environment variable with the time at which the workflow read its sources, s since 1970."""

PLAN_VARIABLE = "SQUEALPIPE_PLAN"
"""Environment variable with the file into which the workflow writes what its results should be."""


KEY_MARK = b"squealpipe key: "

COMMENTS = dict.fromkeys((".svg", ".html"), (b"\n<!-- ", b" -->\n"))
COMMENTS[".json"] = (b',\n "made": "', b'"\n}\n')
"""Ending of a file's name → what stands around its key; else it is a line behind the content."""


def canonical(config: Any) -> str:
    """One text for one meaning: sorted keys, no white space."""
    return json.dumps(config, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest(text: str | bytes) -> str:
    """Sixteen hexadecimal digits of SHA-256."""
    return hashlib.sha256(text.encode() if isinstance(text, str) else text).hexdigest()[
        :16
    ]


def sources(*scripts: Path) -> list[Path]:
    """Scripts and modules whose code decides their results, with all that they import."""
    packages = [  # in a wheel scripts lie below the package too, in folders that are none
        folder / "__init__.py"
        for script in scripts
        for folder in script.parents
        if folder.is_relative_to(PACKAGE) and (folder / "__init__.py").is_file()
    ]
    imported = [path for script in scripts for path in closure(script)]
    files = dict.fromkeys([*scripts, *packages, *imported])
    return [path for path in files if path.name not in WATCHERS]


def used(part: Mapping[str, Any], code: Iterable[Path]) -> list[Path]:
    """Return the files that decide a rule's results: all but the laws that nothing names.

    Where a module imports one law it imports all. A law counts only if the slice of the
    configuration names it, or a module passes its name on, as for a default.
    """
    code, laws = list(code), law_files()
    named = set(re.findall(r"\w+", canonical(part)))
    for path in code:
        named |= read_source(path).laws
    return [path for path in code if path not in laws or laws[path] in named]


def rule_key(
    part: Mapping[str, Any],
    code: Iterable[Path],
    inputs: Mapping[str, str] | None = None,
) -> str:
    """Digest of all that decides the results of a rule.

    Args:
        part: its slice of the configuration; files that it names enter with their content.
        code: what :func:`sources` gives.
    """
    root = PACKAGE.parent
    modules = {
        path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name: (
            read_source(path).code
        )
        for path in used(part, code)
    }
    files = {name: digest(Path(name).read_bytes()) for name in files_named_in(part)}
    # keys of a sweep in the order given, which is that of its dimensions
    return digest(
        json.dumps(part, allow_nan=False)
        + canonical([modules, dict(inputs or {}), files])
    )


def file_key(key: str, path: str | os.PathLike[str]) -> str:
    """The key that a file of a run states: that of its rule, and which of its results it is."""
    parts = Path(path).parts
    place = max(
        (i for i, part in enumerate(parts[:-1]) if part in PARTS),
        default=len(parts) - 1,
    )
    return f"{key} {'/'.join(parts[place:])}"


def refuse_edited(output: str | os.PathLike[str]) -> None:
    """Raise if a module that this process has loaded is younger than the workflow's reading."""
    started = float(os.environ.get(STARTED, "inf"))
    # texts are compared: Paths of all modules take 20 ms, for each of many results
    inside = f"{PACKAGE}{os.sep}"
    own_files: set[str] = set()
    for module in list(sys.modules.values()):
        file = str(getattr(module, "__file__", ""))
        if file.startswith(inside):
            declared = getattr(module, DECLARED_BY, ())
            read = (path for each in declared for path in Path(file).parent.glob(each))
            own_files |= {file, *map(str, read)}
    now = time.time()  # a file dated later has another clock's date, not one of an edit
    edited = [
        Path(file).relative_to(PACKAGE.parent).as_posix()
        for file in sorted(own_files)
        if _is_edited(file, started, now)
    ]
    shown = 3
    if edited:
        more = f" and {len(edited) - shown} more" if len(edited) > shown else ""
        raise RuntimeError(
            f"{output} is not written: {', '.join(edited[:shown])}{more} changed in "
            f"{PACKAGE.parent} while it was computed, by an edit or a new installation; "
            "run the same command again"
        )


def _is_edited(file: str, started: float, now: float) -> bool:
    """Tell whether a file was changed between two times, s since 1970, or is gone."""
    try:
        return started < os.stat(file).st_mtime <= now  # noqa: PTH116
    except FileNotFoundError:
        return True


def state_key(path: str | Path, key: str) -> None:
    """End a finished figure, page or JSON file with its key and the digest of all before."""
    refuse_edited(path)
    target = Path(path)
    before, after = COMMENTS.get(target.suffix, (b"\n% ", b"\n"))
    content = target.read_bytes()
    if target.suffix == ".json":
        content = content.rstrip().removesuffix(b"}").rstrip()
    content += before + KEY_MARK
    target.write_bytes(
        content + f"{file_key(key, path)} {digest(content)}".encode() + after
    )


def key_behind(path: str | Path) -> str | None:
    """The key that a file ends with; None if it states none, or was changed since."""
    content, mark, line = Path(path).read_bytes().rpartition(KEY_MARK)
    keyed = re.fullmatch(
        rb'([0-9a-f]{16} [\w./-]+) ([0-9a-f]{16})(\n| -->\n|"\n}\n)', line
    )
    return (
        keyed[1].decode()
        if keyed and keyed[2].decode() == digest(content + mark)
        else None
    )


def _beside(file: Path, within: tuple[Path, ...] = ()) -> Iterator[str]:
    """Yield files that belong to one of a structure: labels, what a deck reads, laws of contacts.

    Args:
        within: decks that include this one.
    """
    packed = file.suffix.lower() == ".gz"
    plain = file.with_suffix("") if packed else file
    endings = dict.fromkeys((".sti", ".mas"), ".dof")
    endings |= dict.fromkeys((".hb", ".rsa", ".rua", ".matrix"), ".mapping")
    if ending := endings.get(plain.suffix.lower()):
        for each in (plain.with_suffix(ending), plain.with_suffix(f"{ending}.gz")):
            if each.is_file():
                yield each.as_posix()
    tables = (".csv", ".txt", ".tsv", ".dat", ".xlsx")
    if (
        plain.suffix.lower() in tables[:-1]
    ):  # a table of contacts may name tables of force
        cells = re.split(rb"[,;\t\r\n]", file.read_bytes())
        for cell in cells:
            name = cell.decode(errors="replace").strip("\"' ")
            named = Path(os.path.normpath(file.parent / name))
            if name.lower().endswith(tables) and named.is_file() and named != file:
                yield named.as_posix()
    if plain.suffix.lower() == ".inp":
        content = file.read_bytes()
        text = gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content
        for match in re.finditer(rb"(?im)^\*(?!\*).*\bINPUT\s*=\s*([^,\r\n]+)", text):
            name = match[1].decode(errors="replace").strip("\"' ")
            included = Path(os.path.normpath(file.parent / name))
            if included.is_file() and included not in (file, *within):
                yield included.as_posix()
                yield from _beside(included, (file, *within))


def files_named_in(value: Any, folder: Path | None = None) -> Iterator[str]:
    """Files that a slice names: a table of friction, a system or a structure as FILE:NAME.

    A structure's file names others in its folder; labels of CalculiX lie beside its matrices.
    """
    if isinstance(value, str):
        name = value.partition(":")[0]
        file = Path(name) if folder is None else folder / name
        if "." in name and file.is_file():
            yield name if folder is None else file.as_posix()
            yield from _beside(file)
            if folder is None and file.suffix in {".yaml", ".yml"}:
                content = yaml.safe_load(file.read_text(encoding="utf-8"))
                yield from files_named_in(content, file.parent)
    elif isinstance(value, Mapping | list | tuple):
        for item in value.values() if isinstance(value, Mapping) else value:
            yield from files_named_in(item, folder)
