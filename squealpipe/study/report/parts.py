"""Parts that all reports share: pictures, tables of parameters, and how the run came to be."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from PIL import Image

from squealpipe.parameters import TABLE, Parameters, law_in_words
from squealpipe.store.sealed import attributes
from squealpipe.store.whole_files import checksum
from squealpipe.study.figures import declared
from squealpipe.systems.inputs.units import shown_in


@dataclass(frozen=True, kw_only=True)
class Made:
    """Origin of one file of the run."""

    path: Path
    rule: str
    datasets: tuple[str, ...] = ()


def provenance(
    datasets: Mapping[str, Made], figures: Mapping[str, Made]
) -> dict[str, Any]:
    """Rules, ids, checksums, times, configuration and environment of a run, for a file."""
    records: dict[str, dict[str, Any]] = {}
    configuration: dict[str, Any] = {}
    environment: dict[str, set[str]] = {"squealpipe": {version("squealpipe")}}
    for name, made in sorted(datasets.items()):
        stated = attributes(made.path)
        records[name] = {
            "rule": made.rule,
            "made_from": list(made.datasets),
            "sha256": checksum(made.path),
            **{
                key: stated[key]
                for key in ("title", "dataset_id", "config_hash", "wall_time_s")
                if key in stated
            },
        }
        configuration |= json.loads(stated.get("config", "{}"))
        made_with = {key: stated.get(key, "unknown") for key in ("commit", "platform")}
        made_with |= json.loads(stated.get("libraries", "{}"))
        for what, value in made_with.items():
            environment.setdefault(what, set()).add(value)
    return {
        "datasets": records,
        "figures": {
            name: {"rule": made.rule, "datasets": list(made.datasets)}
            for name, made in figures.items()
        },
        "configuration": configuration,
        "environment": {what: sorted(values) for what, values in environment.items()},
    }


def pictures(
    names: Sequence[str], figures: Mapping[str, Made], run: Mapping[str, Any]
) -> dict[str, Any]:
    """Name → what a page needs of each picture that the run has."""
    return {
        name: _picture(name, figures[name], run) for name in names if name in figures
    }


def picture_files(
    content: Mapping[str, Any], figures: Mapping[str, Made]
) -> dict[str, Path]:
    """Path inside the report's source → PNG file, for each picture of the content."""
    return {
        item["path"]: figures[name].path for name, item in content["figures"].items()
    }


def parameter_table(
    parameters: Parameters, *, of_a1: bool = False
) -> list[dict[str, Any]]:
    """Symbol, meaning, value and unit of each parameter, or of those that enter A1 alone.

    A parameter for which the file of a law stands has no row.
    """
    rows = []
    for name, value in parameters.as_dict().items():
        row = TABLE[name]
        if name in parameters.in_laws or (of_a1 and not row.enters_a1):
            continue
        shown, unit = value, ""
        if row.laws:
            shown = law_in_words(value, row.laws.own_law_rules.units)
        elif value is not None:
            factor, unit = shown_in(value, row.units)
            shown = value * factor
        meaning = row.meaning.partition(":")[0] if row.laws else row.meaning
        rows.append(
            {"symbol": row.symbol, "meaning": meaning, "value": shown, "unit": unit}
        )
    return rows


def title(name: str) -> str:
    """Heading of a picture: the paper's number, or the name in words."""
    if paper := re.fullmatch(r"fig(\d+)(?:_to_(\d+))?", name):
        first, last = int(paper[1]), paper[2]
        return f"Figs. {first}–{int(last)}." if last else f"Fig. {first}."
    words = name.removeprefix("own_").replace("_", " ").capitalize()
    return re.sub(r"\ba\d\b", lambda level: level[0].upper(), words) + "."


def made_files(table: Mapping[str, Mapping[str, Any]]) -> dict[str, Made]:
    """``Made`` records from the plain table that :mod:`squealpipe.study.report.lineage` gives."""
    return {
        name: Made(
            path=Path(row["path"]), rule=row["rule"], datasets=tuple(row["datasets"])
        )
        for name, row in table.items()
    }


def _picture(name: str, made: Made, run: Mapping[str, Any]) -> dict[str, Any]:
    caption, alt = declared.texts(name, run)
    with Image.open(made.path) as image:
        width, aspect = image.width / image.info["dpi"][0], image.height / image.width
    return {
        "path": f"pictures/{name}.png",
        "title": title(name),
        "caption": caption,
        "alt": alt,
        "width_inches": width,
        "aspect": aspect,
        "rule": made.rule,
        "datasets": list(made.datasets),
    }


def changed_rows(changed: Sequence[tuple[str, Any, Any]]) -> list[dict[str, str]]:
    """Rows of a table of keys of the configuration, the shipped value and that of this study."""
    return [
        {"key": key, "shipped": _written(shipped), "here": _written(here)}
        for key, shipped, here in changed
    ]


def _written(value: Any) -> str:
    return "–" if value is None else json.dumps(value, ensure_ascii=False).strip('"')
