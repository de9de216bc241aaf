"""Which results were made from another configuration or other code than the study has now.

Snakemake compares with its own records and with dates. It takes for current whatever has no
record (copied results, or those left by `make clean`) and misses sources with an older date. Each
dataset tells the configuration and the code that made it; here they are compared, from the header
line at the end of the file, without opening NetCDF.
"""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from squealpipe.rerun.sources import code_digests

HEADER = b"\n# squealpipe header "
"""Begins the line of a dataset file that tells what it holds, as JSON."""

TAIL = 1 << 16
"""Bytes read at first from the end of a file; as many again and again until the line is whole."""

RECORDS = Path(".snakemake/metadata")


@dataclass(frozen=True)
class Made:
    """What a dataset of the study is to be made from.

    Attributes:
        path: the file, relative to the checkout.
        part: its slice of the configuration.
        sources: files whose code decides its values.
    """

    path: str
    part: Mapping[str, Any]
    sources: tuple[str, ...]


def attributes(path: str | os.PathLike[str]) -> dict[str, Any] | None:
    """Global attributes of a dataset file from its header line; None if it has none."""
    with Path(path).open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        length = 0
        while length < size:
            length = min(size, 2 * length or TAIL)
            file.seek(size - length)
            _, found, line = file.read(length).rpartition(HEADER)
            if found:
                break
        else:
            return None
    try:
        return dict(json.loads(line.split(b"\n", 1)[0])["attrs"])
    except (ValueError, LookupError, TypeError):
        return None


def stale(wanted: Iterable[Made]) -> dict[str, list[str]]:
    """Existing results that are out of date though Snakemake would keep them: path → why."""
    found = {}
    for made in wanted:
        if Path(made.path).is_file():
            reasons = _changed_keys(made) or _changed_code(made)
            if reasons:
                found[made.path] = reasons
    return found


def _changed_keys(made: Made) -> list[str]:
    """``key: old → new``, unless Snakemake's own record tells the same."""
    told = attributes(made.path)
    if told is None or "config" not in told or "code" not in told:
        return (
            []
            if _recorded_params(made.path) is not None
            else ["does not tell what it was made from"]
        )
    old, new = json.loads(told["config"]), json.loads(json.dumps(made.part))
    changes = [
        f"{key}: {before} → {after}"
        for name in new
        for key, before, after in _differences(name, old.get(name, "absent"), new[name])
    ]
    recorded = _recorded_params(made.path)
    seen = recorded is not None and bool(made.part) and repr(made.part) not in recorded
    return [] if seen else changes


def _changed_code(made: Made) -> list[str]:
    """Sources with other code, unless one has a newer date, which Snakemake notices."""
    told = attributes(made.path) or {}
    if "code" not in told:
        return []
    old, new = json.loads(told["code"]), code_digests(made.sources)
    changed = [
        path
        for path, (name, code) in zip(made.sources, new.items(), strict=True)
        if old.get(name) != code
    ]
    written = Path(made.path).stat().st_mtime
    if any(Path(path).stat().st_mtime > written for path in changed):
        return []
    return [f"{path} changed" for path in changed]


def _differences(name: str, old: Any, new: Any) -> list[tuple[str, Any, Any]]:
    if isinstance(old, dict) and isinstance(new, dict):
        return [
            found
            for key in sorted(old.keys() | new.keys())
            for found in _differences(
                f"{name}.{key}", old.get(key, "absent"), new.get(key, "absent")
            )
        ]
    return [] if old == new else [(name, old, new)]


def _recorded_params(path: str) -> list[str] | None:
    """Parameters in Snakemake's record of a file; None if there is no record."""
    name = base64.urlsafe_b64encode(path.encode()).decode()
    try:
        return list(json.loads((RECORDS / name).read_text(encoding="utf-8"))["params"])
    except (OSError, ValueError, LookupError, TypeError):
        return None


def some(names: list[str]) -> str:
    """The first few of many names."""
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
